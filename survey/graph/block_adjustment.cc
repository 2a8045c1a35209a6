// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/block_adjustment.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "survey/geometry/rigid_fit.h"
#include "survey/graph/block_graph.h"
#include "survey/graph/given_control.h"
#include "survey/graph/graph_covariance.h"
#include "survey/graph/graph_residuals.h"
#include "survey/graph/variance_factor.h"

namespace survey {
namespace {

using GivenPoints = std::map<std::string, const ControlPoint*>;

GivenPoints PointsOfRole(const ControlNetwork& control, PointRole role) {
  GivenPoints points;
  for (const ControlPoint& point : control.points) {
    if (point.role == role) points.emplace(point.name, &point);
  }
  return points;
}

const std::string& PointName(const BlockGraph& block, const MarkEdge& mark) {
  return block.point_names[static_cast<std::size_t>(mark.point)];
}

Eigen::Vector2d MarkPosition(const PoseGraph& graph, const MarkEdge& mark) {
  return graph.poses[static_cast<std::size_t>(mark.pose)] * mark.p_in_pose;
}

std::size_t CountControlPoints(const BlockGraph& block, const GivenPoints& given) {
  return static_cast<std::size_t>(std::count_if(block.point_names.begin(), block.point_names.end(),
                                                [&](const std::string& name) { return given.contains(name); }));
}

// One point: the block is shifted onto it; its direction stays that of the first scan.
RigidFit FitTranslation(const Eigen::Vector2d& source, const Eigen::Vector2d& target) {
  RigidFit fit;
  fit.target_from_source = {target.x() - source.x(), target.y() - source.y(), 0.0};
  return fit;
}

std::optional<RigidFit> FitOnMarks(const BlockGraph& block, const GivenPoints& given, std::size_t num_points) {
  std::vector<Eigen::Vector2d> source;
  std::vector<Eigen::Vector2d> target;
  for (const MarkEdge& mark : block.graph.marks) {
    const auto found = given.find(PointName(block, mark));
    if (found == given.end()) continue;
    source.push_back(MarkPosition(block.graph, mark));
    target.push_back(found->second->position_in_site);
  }
  if (num_points == 1) return FitTranslation(source.front(), target.front());
  return FitRigid(source, target);
}

void MoveGraph(const Pose2& target_from_source, PoseGraph* graph) {
  for (Pose2& pose : graph->poses) pose = target_from_source * pose;
  for (Eigen::Vector2d& point : graph->points) point = target_from_source * point;
}

// Coordinates of the control points among the graph's observations; why not possible, or empty.
std::string AddControl(const ControlNetwork& control, const Eigen::Vector2d& offset, BlockGraph* block) {
  GivenControl given = GiveControl(control, block->point_names, {}, offset);
  for (const GivenCoordinates& group : given.given) {
    for (std::size_t k = 0; k < group.points.size(); ++k) {
      block->graph.points[static_cast<std::size_t>(group.points[k])] =
          group.coordinates.segment<2>(2 * static_cast<Eigen::Index>(k));
    }
  }
  block->graph.given = std::move(given.given);
  return given.problem;
}

// Rows minus unknowns.
int DegreesOfFreedom(const PoseGraph& graph) {
  int dof = 3 * static_cast<int>(graph.edges.size()) + 2 * static_cast<int>(graph.marks.size()) -
            3 * static_cast<int>(graph.poses.size()) - 2 * static_cast<int>(graph.points.size()) +
            (graph.fixed_pose ? 3 : 0);
  for (const GivenCoordinates& given : graph.given) dof += 2 * static_cast<int>(given.points.size());
  return dof;
}

// Pose indices of the nodes whose covariances are wanted: every marked one and one per stretch of path.
std::vector<int> NodesForCovariance(const BlockGraph& block, double spacing_m) {
  std::vector<bool> marked(block.graph.poses.size(), false);
  for (const MarkEdge& mark : block.graph.marks) marked[static_cast<std::size_t>(mark.pose)] = true;
  std::vector<int> chosen;
  double way = spacing_m;
  for (std::size_t i = block.num_submaps; i < block.graph.poses.size(); ++i) {
    if (i > block.num_submaps)
      way += (block.graph.poses[i].Translation() - block.graph.poses[i - 1].Translation()).norm();
    if (!marked[i] && way < spacing_m) continue;
    chosen.push_back(static_cast<int>(i));
    if (way >= spacing_m) way = 0.0;
  }
  return chosen;
}

class Writer {
 public:
  Writer(const Track& track, const BlockGraph& block, const Eigen::Vector2d& offset, Solution* solution)
      : track_(track), block_(block), offset_(offset), solution_(*solution) {}

  void Poses(const std::vector<StampNs>& stamps) {
    const std::vector<Pose2> poses = PosesOfAllScans(track_, block_, stamps);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      solution_.scans.push_back({track_.scans[i].scan, InSite(poses[i]), track_.scans[i].is_node});
    }
    for (const Submap& submap : track_.submaps) {
      solution_.submaps.push_back({submap.id, InSite(block_.graph.poses[static_cast<std::size_t>(submap.id.value)])});
    }
  }

  void Covariances(double spacing_m) {
    const std::vector<int> chosen = NodesForCovariance(block_, spacing_m);
    const std::vector<Eigen::Matrix3d> covariances = PoseCovariances(block_.graph, chosen);
    for (std::size_t i = 0; i < covariances.size(); ++i) {
      covariance_of_[chosen[i]] = covariances[i];
      solution_.covariances.push_back(
          {block_.nodes[static_cast<std::size_t>(chosen[i]) - block_.num_submaps], covariances[i]});
    }
  }

  void Marks(const GivenPoints& given, const std::vector<Eigen::Vector2d>& rigid_positions) {
    for (std::size_t i = 0; i < track_.marks.size(); ++i) {
      const TrackedMark& tracked = track_.marks[i];
      const MarkEdge& edge = block_.graph.marks[i];
      SolvedMark mark{
          .point = tracked.point, .start_ns = tracked.start_ns, .end_ns = tracked.end_ns, .scan = tracked.scan};
      mark.position_in_site = MarkPosition(block_.graph, edge) + offset_;
      mark.covariance = PositionCovariance(edge);
      if (const auto found = given.find(tracked.point); found != given.end()) {
        mark.used = true;
        mark.residual = mark.position_in_site - found->second->position_in_site;
        mark.rigid_residual = rigid_positions[i] - found->second->position_in_site;
      }
      solution_.marks.push_back(std::move(mark));
    }
  }

 private:
  Pose2 InSite(const Pose2& pose) const { return {pose.x + offset_.x(), pose.y + offset_.y(), pose.theta}; }

  // Of the marked place: the pose's covariance carried through the lever arm, and the centring.
  Eigen::Matrix2d PositionCovariance(const MarkEdge& edge) const {
    const auto found = covariance_of_.find(edge.pose);
    if (found == covariance_of_.end()) return Eigen::Matrix2d::Zero();
    const Eigen::Matrix2d rotation = Rotation2(block_.graph.poses[static_cast<std::size_t>(edge.pose)].theta);
    const Eigen::Vector2d lever = rotation * edge.p_in_pose;
    Eigen::Matrix<double, 2, 3> d_pose;
    d_pose << 1, 0, -lever.y(), 0, 1, lever.x();
    return d_pose * found->second * d_pose.transpose() + rotation * edge.covariance * rotation.transpose();
  }

  const Track& track_;
  const BlockGraph& block_;
  Eigen::Vector2d offset_;
  Solution& solution_;
  std::map<int, Eigen::Matrix3d> covariance_of_;
};

BlockAdjustment Failed(std::string message) { return {.usable = false, .message = std::move(message), .solution = {}}; }

}  // namespace

BlockAdjustment AdjustBlock(const Track& track, const Loops& loops, const ControlNetwork& control,
                            const std::vector<StampNs>& stamps, const BlockAdjustmentOptions& options) {
  if (track.submaps.empty()) return Failed("the track has no submap");
  BlockGraph block = MakeBlockGraph(track);
  int accepted = 0;
  for (const Loop& loop : loops.loops) {
    if (!loop.accepted) continue;
    AddLoop(loop.constraint, &block);
    ++accepted;
  }

  // Free solution: what the sensors alone say.
  PoseGraphOptions free_options = options.solver;
  free_options.chordal_start = true;  // a long tour may have drifted far
  PoseGraphSummary summary = Solve(&block.graph, free_options);
  if (!summary.usable) return Failed("the free adjustment did not converge: " + summary.message);
  // From here on with covariances that the block itself has confirmed.
  const double factor = VarianceFactorOfLoops(block.graph, options.solver.robust_scale).factor;
  for (PoseEdge& edge : block.graph.edges) edge.covariance *= factor;
  summary.initial_cost /= factor;
  summary.final_cost /= factor;

  const GivenPoints given = PointsOfRole(control, PointRole::kControl);
  const std::size_t num_points = CountControlPoints(block, given);
  BlockAdjustment result;
  Solution& solution = result.solution;
  solution.tied = num_points > 0;
  solution.navigation = track.navigation;
  solution.breaks = BreaksOf(track);
  if (num_points == 1 && !options.allow_single_point) {
    const auto marked = std::find_if(block.point_names.begin(), block.point_names.end(),
                                     [&](const std::string& name) { return given.contains(name); });
    return Failed("the block's marks.csv stands on one control point only, " + *marked +
                  ": it fixes the place but not the direction; mark a second one, or set allow-single-point = true "
                  "under [adjust] in block.toml");
  }
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> rigid_positions(block.graph.marks.size(), Eigen::Vector2d::Zero());
  if (solution.tied) {
    solution.frame = control.frame;
    const std::optional<RigidFit> fit = FitOnMarks(block, given, num_points);
    if (!fit) return Failed("the marked control points lie on one place: the direction of the block cannot be fixed");
    solution.site_from_local = fit->target_from_source;
    solution.rigid_scale = fit->similarity_scale;
    // Near zero the sums keep their digits; UTM northings would cost six of them.
    offset = Eigen::Vector2d(std::round(fit->target_from_source.x), std::round(fit->target_from_source.y));
    const Pose2 moved{fit->target_from_source.x - offset.x(), fit->target_from_source.y - offset.y(),
                      fit->target_from_source.theta};
    MoveGraph(moved, &block.graph);
    for (std::size_t i = 0; i < block.graph.marks.size(); ++i)
      rigid_positions[i] = MarkPosition(block.graph, block.graph.marks[i]) + offset;
    if (num_points > 1) {
      const std::string problem = AddControl(control, offset, &block);
      if (!problem.empty()) return Failed(problem);
      block.graph.fixed_pose.reset();
      summary = Solve(&block.graph, options.solver);
      if (!summary.usable) return Failed("the adjustment with control did not converge: " + summary.message);
    }
  }

  Writer writer(track, block, offset, &solution);
  writer.Poses(stamps);
  writer.Covariances(options.covariance_spacing_m);
  writer.Marks(given, rigid_positions);
  AdjustmentStatistics& statistics = solution.statistics;
  statistics.num_nodes = static_cast<int>(block.nodes.size());
  statistics.num_submaps = static_cast<int>(block.num_submaps);
  statistics.num_track_constraints = static_cast<int>(block.graph.edges.size()) - accepted;
  statistics.num_loops = accepted;
  statistics.num_control_marks = static_cast<int>(
      std::count_if(solution.marks.begin(), solution.marks.end(), [](const SolvedMark& mark) { return mark.used; }));
  statistics.degrees_of_freedom = DegreesOfFreedom(block.graph);
  statistics.iterations = summary.iterations;
  statistics.initial_cost = summary.initial_cost;
  statistics.final_cost = summary.final_cost;
  statistics.sigma_zero =
      statistics.degrees_of_freedom > 0 ? std::sqrt(2.0 * summary.final_cost / statistics.degrees_of_freedom) : 0.0;
  result.usable = true;
  return result;
}

}  // namespace survey
