// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/graph_covariance.h"

#include <Eigen/Cholesky>

#include "survey/graph/graph_residuals.h"

namespace survey {
namespace {

const Pose2& PoseOf(const PoseGraph& graph, int pose) { return graph.poses[static_cast<std::size_t>(pose)]; }

RelativePoseResidual Residual(const PoseGraph& graph, const PoseEdge& edge) {
  return EvaluateRelativePose(PoseOf(graph, edge.base), PoseOf(graph, edge.target), edge.base_from_target);
}

}  // namespace

std::optional<GraphCovariance> GraphCovariance::Of(const PoseGraph& graph) {
  NormalEquations equations = FormNormalEquations(graph);
  const OrderedFactor factor(equations.lower);
  std::optional<SelectedInverse> inverse = SelectedInverse::Of(equations.lower, factor);
  if (!inverse) return std::nullopt;
  return GraphCovariance(graph, std::move(equations.columns), *std::move(inverse), factor.solve(equations.right));
}

Eigen::Matrix3d GraphCovariance::Between(int pose, int other) const {
  const int row = columns_.of_pose[static_cast<std::size_t>(pose)];
  const int column = columns_.of_pose[static_cast<std::size_t>(other)];
  if (row < 0 || column < 0) return Eigen::Matrix3d::Zero();
  return inverse_.Block<3, 3>(row, column);
}

Eigen::Matrix3d GraphCovariance::OfPose(int pose) const { return Between(pose, pose); }

Eigen::Matrix3d GraphCovariance::OfAdjusted(const PoseEdge& edge) const {
  const RelativePoseResidual r = Residual(*graph_, edge);
  const Eigen::Matrix3d cross = r.d_base * Between(edge.base, edge.target) * r.d_target.transpose();
  return r.d_base * OfPose(edge.base) * r.d_base.transpose() +
         r.d_target * OfPose(edge.target) * r.d_target.transpose() + cross + cross.transpose();
}

void GraphCovariance::TakeStep(PoseGraph* graph) const {
  for (std::size_t i = 0; i < graph->poses.size(); ++i) {
    const int column = columns_.of_pose[i];
    if (column < 0) continue;
    Pose2& pose = graph->poses[i];
    pose = {pose.x + step_(column), pose.y + step_(column + 1), NormalizeAngle(pose.theta + step_(column + 2))};
  }
  for (std::size_t i = 0; i < graph->points.size(); ++i) {
    if (columns_.of_point[i] >= 0) graph->points[i] += step_.segment<2>(columns_.of_point[i]);
  }
}

double GraphCovariance::RedundancyOf(const PoseEdge& edge) const {
  return 3.0 - edge.covariance.llt().solve(OfAdjusted(edge)).trace();
}

Eigen::Matrix3d GraphCovariance::OfResidual(const PoseEdge& edge) const { return edge.covariance - OfAdjusted(edge); }

Eigen::Matrix2d CovarianceOfMark(const MarkEdge& mark, const Pose2& pose, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix2d rotation = Rotation2(pose.theta);
  const Eigen::Vector2d lever = rotation * mark.p_in_pose;
  Eigen::Matrix<double, 2, 3> d_pose;
  d_pose << 1, 0, -lever.y(), 0, 1, lever.x();
  return d_pose * covariance * d_pose.transpose() + rotation * mark.covariance * rotation.transpose();
}

}  // namespace survey
