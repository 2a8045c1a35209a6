// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/chordal_start.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <complex>
#include <vector>

namespace survey {
namespace {

using Complex = std::complex<double>;

// Unknowns are the poses but the held one, in their order.
int Column(int pose, int held) { return pose < held ? pose : pose - 1; }

template <typename Scalar>
std::optional<Eigen::Matrix<Scalar, Eigen::Dynamic, 1>> SolveNormal(int columns,
                                                                    const std::vector<Eigen::Triplet<Scalar>>& lower,
                                                                    const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& b) {
  Eigen::SparseMatrix<Scalar> normal(columns, columns);
  normal.setFromTriplets(lower.begin(), lower.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<Scalar>, Eigen::Lower> factor(normal);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd pivots = factor.vectorD().real();
  if (!(pivots.minCoeff() > 1e-12 * pivots.maxCoeff())) return std::nullopt;
  return Eigen::Matrix<Scalar, Eigen::Dynamic, 1>(factor.solve(b));
}

// Minimises sum |z_target - z_base e^(i measured)|^2 / variance over complex numbers z; their angles are the headings.
bool SolveHeadings(int held, PoseGraph* graph) {
  const int columns = static_cast<int>(graph->poses.size()) - 1;
  const Complex held_heading = std::polar(1.0, graph->poses[static_cast<std::size_t>(held)].theta);
  std::vector<Eigen::Triplet<Complex>> normal;
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(columns);
  for (const PoseEdge& edge : graph->edges) {
    const double weight = 1.0 / edge.covariance(2, 2);
    const Complex turn = weight * std::polar(1.0, edge.base_from_target.theta);
    const int base = Column(edge.base, held);
    const int target = Column(edge.target, held);
    if (edge.base != held) normal.emplace_back(base, base, weight);
    if (edge.target != held) normal.emplace_back(target, target, weight);
    if (edge.base == held) {
      right(target) += turn * held_heading;
    } else if (edge.target == held) {
      right(base) += std::conj(turn) * held_heading;
    } else if (target > base) {
      normal.emplace_back(target, base, -turn);
    } else {
      normal.emplace_back(base, target, -std::conj(turn));
    }
  }
  const auto headings = SolveNormal<Complex>(columns, normal, right);
  if (!headings) return false;
  for (int i = 0; i < static_cast<int>(graph->poses.size()); ++i) {
    if (i != held) graph->poses[static_cast<std::size_t>(i)].theta = std::arg((*headings)(Column(i, held)));
  }
  return true;
}

// Minimises the translation part of [CN] eq. (10) with the headings as they are.
bool SolvePositions(int held, PoseGraph* graph) {
  const int columns = 2 * (static_cast<int>(graph->poses.size()) - 1);
  std::vector<Eigen::Triplet<double>> normal;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
  const Eigen::Vector2d held_position = graph->poses[static_cast<std::size_t>(held)].Translation();
  const auto add = [&](int row, int column, const Eigen::Matrix2d& block) {
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        if (row + i >= column + j) normal.emplace_back(row + i, column + j, block(i, j));
      }
    }
  };
  for (const PoseEdge& edge : graph->edges) {
    const Eigen::Matrix2d rotation = Rotation2(graph->poses[static_cast<std::size_t>(edge.base)].theta);
    const Eigen::Matrix2d weight = rotation * edge.covariance.topLeftCorner<2, 2>().inverse() * rotation.transpose();
    const Eigen::Vector2d pull = weight * (rotation * edge.base_from_target.Translation());
    const int base = 2 * Column(edge.base, held);
    const int target = 2 * Column(edge.target, held);
    if (edge.base != held) {
      add(base, base, weight);
      right.segment<2>(base) -= pull;
    }
    if (edge.target != held) {
      add(target, target, weight);
      right.segment<2>(target) += pull;
    }
    if (edge.base == held) {
      right.segment<2>(target) += weight * held_position;
    } else if (edge.target == held) {
      right.segment<2>(base) += weight * held_position;
    } else {
      add(std::max(base, target), std::min(base, target), -weight);
    }
  }
  const auto positions = SolveNormal<double>(columns, normal, right);
  if (!positions) return false;
  for (int i = 0; i < static_cast<int>(graph->poses.size()); ++i) {
    if (i == held) continue;
    Pose2& pose = graph->poses[static_cast<std::size_t>(i)];
    pose.x = (*positions)(2 * Column(i, held));
    pose.y = (*positions)(2 * Column(i, held) + 1);
  }
  return true;
}

void PutPointsOnTheirMarks(PoseGraph* graph) {
  std::vector<Eigen::Vector2d> sum(graph->points.size(), Eigen::Vector2d::Zero());
  std::vector<double> count(graph->points.size(), 0.0);
  for (const MarkEdge& mark : graph->marks) {
    sum[static_cast<std::size_t>(mark.point)] += graph->poses[static_cast<std::size_t>(mark.pose)] * mark.p_in_pose;
    count[static_cast<std::size_t>(mark.point)] += 1.0;
  }
  for (std::size_t i = 0; i < graph->points.size(); ++i) {
    if (count[i] > 0.0) graph->points[i] = sum[i] / count[i];
  }
}

}  // namespace

std::optional<PoseGraph> ChordalStart(const PoseGraph& graph) {
  if (!graph.fixed_pose || graph.poses.size() < 2) return std::nullopt;
  PoseGraph start = graph;
  if (!SolveHeadings(*graph.fixed_pose, &start) || !SolvePositions(*graph.fixed_pose, &start)) return std::nullopt;
  PutPointsOnTheirMarks(&start);
  return start;
}

}  // namespace survey
