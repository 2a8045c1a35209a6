// SPDX-License-Identifier: Apache-2.0
//
// The back end: least squares over poses of the plane and marked points, [CN] eq. (8)-(11), solved by Ceres.
// One frame for all poses and points, metres; large offsets (UTM) are the caller's to remove.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/submaps/wall_relation.h"

namespace survey {

// Kinds of relative observations: a node in the submap that it helped to draw; from node to node along the track; a
// scan in a submap that is not its neighbour.
enum class EdgeKind { kScanMatch, kMotion, kLoop, kAnswer };

constexpr std::string_view Name(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::kScanMatch:
      return "scan match";
    case EdgeKind::kMotion:
      return "motion";
    case EdgeKind::kLoop:
      return "loop";
    case EdgeKind::kAnswer:
      return "answer";
  }
  return "";
}

/// Of a pose or point among those of its graph.
inline std::size_t IndexOf(int value) { return static_cast<std::size_t>(value); }

// [CN] eq. (10): measured pose of `target` in the frame of `base`.
struct PoseEdge {
  int base = 0;
  int target = 0;
  Pose2 base_from_target;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // x, y (m), theta (rad)
  bool robust = false;  // under the robust loss: measurements that may be wrong altogether (loop closures)
  EdgeKind kind = EdgeKind::kScanMatch;
  bool blind = false;  // a motion without any match: its covariance is not scaled with that of the track
};

inline bool IsLoop(const PoseEdge& edge) { return edge.kind == EdgeKind::kLoop; }

// [CN] eq. (11): the point stood at p_in_pose of a pose.
struct MarkEdge {
  int pose = 0;
  int point = 0;
  Eigen::Vector2d p_in_pose = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  // in the frame of the pose
};

// Two walls, each seen from a pose, whose relation is known.
struct WallEdge {
  int base = 0;
  int target = 0;
  WallPair walls;
  Eigen::Vector2d sigma = {0.05, 0.02};  // m, rad
};

// Coordinates that were given for some points: observations with their joint covariance, m2; in both, x and y of each
// point follow one another. A point without given coordinates only ties its marks together.
struct GivenCoordinates {
  std::vector<int> points;
  Eigen::VectorXd coordinates;
  Eigen::MatrixXd covariance;
};

struct PoseGraph {
  std::vector<Pose2> poses;
  std::vector<Eigen::Vector2d> points;
  std::vector<PoseEdge> edges;
  std::vector<MarkEdge> marks;
  std::vector<WallEdge> walls;
  std::vector<GivenCoordinates> given;  // no point twice
  // The datum: without control the gauge is free in three parameters and this pose is held. With two control points or
  // more none is held.
  std::optional<int> fixed_pose;
};

struct PoseGraphOptions {
  double robust_scale = 2.0;  // in sigmas: beyond, a robust edge loses weight (Cauchy)
  int max_iterations = 100;
  double negligible_cost = 0.0;  // ends after a step that lowers the cost by less
  bool chordal_start = false;  // also try ChordalStart and begin from whichever costs less: where poses may be far off
};

struct PoseGraphSummary {
  bool usable = false;
  std::string message;
  int iterations = 0;
  double initial_cost = 0.0;  // half the sum of squared whitened residuals, robust loss applied
  double final_cost = 0.0;
};

// Moves poses and points to the minimum.
PoseGraphSummary Solve(PoseGraph* graph, const PoseGraphOptions& options);

// Rows minus unknowns.
int DegreesOfFreedom(const PoseGraph& graph);

// Whitened residual of an edge, squared: chi-square with three degrees of freedom when the covariance is true.
double SquaredNormalisedResidual(const PoseEdge& edge, const std::vector<Pose2>& poses);

}  // namespace survey
