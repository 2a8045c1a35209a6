// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/graph_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "survey/graph/graph_residuals.h"

namespace survey {
namespace {

// The lower triangle of the normal matrix, block by block.
class NormalMatrix {
 public:
  explicit NormalMatrix(int columns) : columns_(columns) {}

  // Adds block to (row, column) and, outside the diagonal, means its transpose too. A negative place is held: nothing.
  template <typename Block>
  void Add(int row, int column, const Block& block) {
    if (row < 0 || column < 0) return;
    for (int i = 0; i < static_cast<int>(block.rows()); ++i) {
      for (int j = 0; j < static_cast<int>(block.cols()); ++j) {
        if (row != column && row < column) {
          entries_.emplace_back(column + j, row + i, block(i, j));
        } else if (row + i >= column + j) {
          entries_.emplace_back(row + i, column + j, block(i, j));
        }
      }
    }
  }

  Eigen::SparseMatrix<double> Lower() const {
    Eigen::SparseMatrix<double> lower(columns_, columns_);
    lower.setFromTriplets(entries_.begin(), entries_.end());
    return lower;
  }

 private:
  int columns_;
  std::vector<Eigen::Triplet<double>> entries_;
};

const Pose2& PoseOf(const PoseGraph& graph, int pose) { return graph.poses[static_cast<std::size_t>(pose)]; }

RelativePoseResidual Residual(const PoseGraph& graph, const PoseEdge& edge) {
  return EvaluateRelativePose(PoseOf(graph, edge.base), PoseOf(graph, edge.target), edge.base_from_target);
}

}  // namespace

std::optional<GraphCovariance> GraphCovariance::Of(const PoseGraph& graph) {
  std::vector<int> column_of(graph.poses.size(), -1);
  int columns = 0;
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    if (graph.fixed_pose && *graph.fixed_pose == static_cast<int>(i)) continue;
    column_of[i] = columns;
    columns += 3;
  }
  const int first_point = columns;
  columns += 2 * static_cast<int>(graph.points.size());

  NormalMatrix normal(columns);
  for (const PoseEdge& edge : graph.edges) {
    const RelativePoseResidual r = Residual(graph, edge);
    const Eigen::Matrix3d weight = edge.covariance.inverse();
    const int base = column_of[static_cast<std::size_t>(edge.base)];
    const int target = column_of[static_cast<std::size_t>(edge.target)];
    normal.Add(base, base, r.d_base.transpose() * weight * r.d_base);
    normal.Add(target, target, r.d_target.transpose() * weight * r.d_target);
    normal.Add(base, target, r.d_base.transpose() * weight * r.d_target);
  }
  for (const MarkEdge& mark : graph.marks) {
    const MarkResidual r = EvaluateMark(PoseOf(graph, mark.pose),
                                        graph.points[static_cast<std::size_t>(mark.point)].position, mark.p_in_pose);
    const Eigen::Matrix2d weight = mark.covariance.inverse();
    const int pose = column_of[static_cast<std::size_t>(mark.pose)];
    const int point = first_point + 2 * mark.point;
    normal.Add(pose, pose, r.d_pose.transpose() * weight * r.d_pose);
    normal.Add(point, point, r.d_point.transpose() * weight * r.d_point);
    normal.Add(point, pose, r.d_point.transpose() * weight * r.d_pose);
  }
  for (std::size_t i = 0; i < graph.points.size(); ++i) {
    if (!graph.points[i].prior_covariance) continue;
    const int point = first_point + 2 * static_cast<int>(i);
    normal.Add(point, point, graph.points[i].prior_covariance->inverse());
  }
  std::optional<SelectedInverse> inverse = SelectedInverse::Of(normal.Lower());
  if (!inverse) return std::nullopt;
  return GraphCovariance(graph, std::move(column_of), *std::move(inverse));
}

Eigen::Matrix3d GraphCovariance::Between(int pose, int other) const {
  const int row = column_of_[static_cast<std::size_t>(pose)];
  const int column = column_of_[static_cast<std::size_t>(other)];
  if (row < 0 || column < 0) return Eigen::Matrix3d::Zero();
  return inverse_.Block<3, 3>(row, column);
}

Eigen::Matrix3d GraphCovariance::OfPose(int pose) const { return Between(pose, pose); }

double GraphCovariance::RedundancyOf(const PoseEdge& edge) const {
  const RelativePoseResidual r = Residual(*graph_, edge);
  const Eigen::Matrix3d cross = r.d_base * Between(edge.base, edge.target) * r.d_target.transpose();
  const Eigen::Matrix3d of_adjusted = r.d_base * OfPose(edge.base) * r.d_base.transpose() +
                                      r.d_target * OfPose(edge.target) * r.d_target.transpose() + cross +
                                      cross.transpose();
  return 3.0 - edge.covariance.llt().solve(of_adjusted).trace();
}

std::vector<Eigen::Matrix3d> PoseCovariances(const PoseGraph& graph, const std::vector<int>& poses) {
  const std::optional<GraphCovariance> covariance = GraphCovariance::Of(graph);
  std::vector<Eigen::Matrix3d> result;
  if (!covariance) return result;
  result.reserve(poses.size());
  for (const int pose : poses) result.push_back(covariance->OfPose(pose));
  return result;
}

}  // namespace survey
