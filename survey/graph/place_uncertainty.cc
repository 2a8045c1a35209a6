// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/place_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMostPoses = 60;
constexpr double kNear_m = 2.0;    // poses that are nearer draw no more of a place
constexpr double kAlike_m = 30.0;  // so far apart, errors are alike by 1/e: as control and loops leave them in garages

// What a pose adds to the error of the place, times three independent errors of 1.
struct Share {
  Vector2d position;
  Eigen::Matrix<double, 2, 3> error;
};

// Symmetric, so that it changes steadily from pose to pose.
Eigen::Matrix3d SquareRootOf(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

Share ShareOf(const Vector2d& place, const Vector2d& position, const Eigen::Matrix3d& covariance) {
  const Vector2d lever = place - position;
  Eigen::Matrix<double, 2, 3> by_pose;
  by_pose << 1, 0, -lever.y(), 0, 1, lever.x();
  return {position, by_pose * SquareRootOf(covariance)};
}

// Beams on a place grow fewer with the distance, and so do the scans that look at it.
double WeightOf(const Vector2d& place, const Vector2d& position) {
  return 1.0 / ((position - place).squaredNorm() + kNear_m * kNear_m);
}

std::vector<Share> SharesOf(const Vector2d& place, const Solution& solution) {
  const auto position_of = [&](const NodeCovariance& node) -> Vector2d {
    return solution.scans[static_cast<std::size_t>(node.scan.value)].site_from_scan.Translation();
  };
  std::vector<NodeCovariance> nodes = solution.covariances;
  std::stable_sort(nodes.begin(), nodes.end(), [&](const NodeCovariance& a, const NodeCovariance& b) {
    return (position_of(a) - place).squaredNorm() < (position_of(b) - place).squaredNorm();
  });
  nodes.resize(std::min(kMostPoses, nodes.size()));
  double weights = 0.0;
  for (const NodeCovariance& node : nodes) weights += WeightOf(place, position_of(node));
  std::vector<Share> shares;
  for (const NodeCovariance& node : nodes) {
    shares.push_back(ShareOf(place, position_of(node), node.covariance));
    shares.back().error *= WeightOf(place, position_of(node)) / weights;
  }
  return shares;
}

}  // namespace

std::optional<Eigen::Matrix2d> PlaceCovariance(const Vector2d& place, const Solution& solution) {
  if (solution.covariances.empty()) return std::nullopt;
  const std::vector<Share> shares = SharesOf(place, solution);
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Share& a : shares) {
    for (const Share& b : shares)
      covariance += std::exp(-(a.position - b.position).norm() / kAlike_m) * a.error * b.error.transpose();
  }
  return covariance;
}

}  // namespace survey
