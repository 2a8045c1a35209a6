// SPDX-License-Identifier: Apache-2.0
#include "survey/planning/control_plan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "survey/graph/control_misfit.h"
#include "survey/graph/graph_covariance.h"

namespace survey {
namespace {

using Eigen::Index;

// Poses from `first` on, one per stretch of path.
std::vector<int> PosesAlong(const PoseGraph& graph, int first, double spacing_m) {
  std::vector<int> chosen;
  double way = spacing_m;
  for (auto i = static_cast<std::size_t>(first); i < graph.poses.size(); ++i) {
    if (static_cast<int>(i) > first) way += (graph.poses[i].Translation() - graph.poses[i - 1].Translation()).norm();
    if (way < spacing_m) continue;
    chosen.push_back(static_cast<int>(i));
    way = 0.0;
  }
  return chosen;
}

// The free network with a mark and a control point at each candidate.
struct Candidates {
  PoseGraph graph;
  std::vector<GivenCoordinates> given;
};

Candidates MarkCandidates(const PoseGraph& free, const std::vector<int>& poses, const ControlPlanOptions& options) {
  Candidates candidates{.graph = free};
  candidates.graph.marks.clear();
  candidates.graph.points.clear();
  candidates.graph.given.clear();
  for (const int pose : poses) {
    const int point = static_cast<int>(candidates.graph.points.size());
    const Eigen::Vector2d place = free.poses[static_cast<std::size_t>(pose)].Translation();
    candidates.graph.points.push_back(place);
    candidates.graph.marks.push_back({pose, point, Eigen::Vector2d::Zero(),
                                      options.mark_sigma_m * options.mark_sigma_m * Eigen::Matrix2d::Identity()});
    candidates.given.push_back(
        {{point}, place, options.control_sigma_m * options.control_sigma_m * Eigen::Matrix2d::Identity()});
  }
  return candidates;
}

class Planner {
 public:
  Planner(const PoseGraph& graph, ControlMisfit misfit, std::vector<int> path, const GraphCovariance& covariance)
      : graph_(graph), misfit_(std::move(misfit)), path_(std::move(path)) {
    for (const int pose : path_) of_free_.push_back(covariance.OfPose(pose).topLeftCorner<2, 2>());
    own_ = misfit_.of_network + misfit_.of_marks + misfit_.of_control;
  }

  // sigma_x^2 + sigma_y^2 of each pose of the path with control at these candidates; empty where the datum is not
  // determined.
  std::vector<double> Variances(const std::vector<int>& chosen) const {
    std::vector<Index> rows;
    for (const int candidate : chosen) {
      rows.push_back(2 * candidate);
      rows.push_back(2 * candidate + 1);
    }
    const Eigen::MatrixXd weight = own_(rows, rows).inverse();
    const Eigen::Matrix<double, Eigen::Dynamic, 3> datum = misfit_.datum(rows, Eigen::all);
    const Eigen::Matrix<double, Eigen::Dynamic, 3> weighted = weight * datum;
    const Eigen::LLT<Eigen::Matrix3d> normal(datum.transpose() * weighted);
    if (normal.info() != Eigen::Success) return {};
    const Eigen::Matrix3d of_datum = normal.solve(Eigen::Matrix3d::Identity());
    std::vector<double> variances;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const Index row = 2 * path_[i];
      const Eigen::MatrixXd with_marks = misfit_.poses_with_marks(Eigen::seqN(row, 2), rows);
      const Eigen::Matrix<double, 2, 3> by_datum = misfit_.datum_of_poses.middleRows<2>(row) - with_marks * weighted;
      const Eigen::Matrix2d covariance =
          of_free_[i] - with_marks * weight * with_marks.transpose() + by_datum * of_datum * by_datum.transpose();
      variances.push_back(std::max(0.0, covariance.trace()));
    }
    return variances;
  }

  double MeanVariance(const std::vector<int>& chosen) const {
    const std::vector<double> variances = Variances(chosen);
    if (variances.empty()) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (const double variance : variances) sum += variance;
    return sum / static_cast<double>(variances.size());
  }

  // The best pair to begin with, by exchanging one of both as long as that helps.
  std::vector<int> BestPair() const {
    std::vector<int> pair = {0, misfit_.size() - 1};
    for (double least = MeanVariance(pair);;) {
      const double before = least;
      for (const std::size_t which : {0U, 1U}) {
        for (int candidate = 0; candidate < misfit_.size(); ++candidate) {
          std::vector<int> other = pair;
          other[which] = candidate;
          if (other[0] == other[1]) continue;
          const double variance = MeanVariance(other);
          if (variance >= least) continue;
          least = variance;
          pair = other;
        }
      }
      if (!(least < before)) return pair;
    }
  }

  // -1 when all are taken.
  int BestNext(const std::vector<int>& chosen) const {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int candidate = 0; candidate < misfit_.size(); ++candidate) {
      if (std::find(chosen.begin(), chosen.end(), candidate) != chosen.end()) continue;
      std::vector<int> with = chosen;
      with.push_back(candidate);
      const double variance = MeanVariance(with);
      if (variance >= least) continue;
      least = variance;
      best = candidate;
    }
    return best;
  }

  PlanStep StepOf(const std::vector<int>& chosen) const {
    const int pose = graph_.marks[static_cast<std::size_t>(chosen.back())].pose;
    PlanStep step{.pose = pose, .place = graph_.poses[static_cast<std::size_t>(pose)].Translation()};
    if (chosen.size() < 2) return step;
    const std::vector<double> variances = Variances(chosen);
    step.rms = std::sqrt(MeanVariance(chosen));
    if (!variances.empty()) step.max = std::sqrt(*std::max_element(variances.begin(), variances.end()));
    return step;
  }

  ControlPlan Plan(std::size_t num_taken, std::size_t max_points) const {
    std::vector<int> chosen;
    ControlPlan plan{.path = path_};
    const auto take = [&](int candidate) {
      chosen.push_back(candidate);
      plan.steps.push_back(StepOf(chosen));
    };
    for (std::size_t i = 0; i < num_taken; ++i) take(static_cast<int>(i));
    if (chosen.empty()) {
      for (const int candidate : BestPair()) take(candidate);
    }
    while (chosen.size() < max_points) {
      const int next = BestNext(chosen);
      if (next < 0) break;
      take(next);
    }
    for (const double variance : Variances(chosen)) plan.sigma_of_path.push_back(std::sqrt(variance));
    return plan;
  }

 private:
  const PoseGraph& graph_;  // with marks at the candidates
  ControlMisfit misfit_;
  std::vector<int> path_;
  std::vector<Eigen::Matrix2d> of_free_;
  Eigen::MatrixXd own_;  // covariance of the misfits
};

}  // namespace

std::optional<ControlPlan> PlanControl(const PoseGraph& graph, int first_node, const std::vector<int>& taken,
                                       const ControlPlanOptions& options) {
  PoseGraph free = graph;
  free.fixed_pose = 0;
  free.given.clear();
  const auto covariance = GraphCovariance::Of(free);
  std::vector<int> poses = taken;
  for (const int pose : PosesAlong(graph, first_node, options.candidate_spacing_m)) {
    if (std::find(taken.begin(), taken.end(), pose) == taken.end()) poses.push_back(pose);
  }
  if (!covariance || poses.size() < 2) return std::nullopt;
  const Candidates candidates = MarkCandidates(free, poses, options);
  std::optional<ControlMisfit> misfit = MisfitOfControl(candidates.graph, candidates.given);
  if (!misfit) return std::nullopt;
  const Planner planner(candidates.graph, *std::move(misfit), PosesAlong(graph, first_node, options.path_spacing_m),
                        *covariance);
  return planner.Plan(taken.size(), static_cast<std::size_t>(options.max_points));
}

}  // namespace survey
