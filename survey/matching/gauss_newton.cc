// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/gauss_newton.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace survey {

OccupancyCost EvaluateOccupancyCost(const OccupancyPyramid& map, int level,
                                    std::span<const Eigen::Vector2f> points_in_scan, const Pose2& map_from_scan,
                                    double residual_sigma) {
  const auto c = static_cast<float>(std::cos(map_from_scan.theta));
  const auto s = static_cast<float>(std::sin(map_from_scan.theta));
  const auto tx = static_cast<float>(map_from_scan.x);
  const auto ty = static_cast<float>(map_from_scan.y);
  double squares = 0;
  double occupancy = 0;
  // Sums of J'J (upper triangle) and J'r, J = dM/d(x, y, theta), r = 1 - M.
  double hxx = 0, hxy = 0, hxt = 0, hyy = 0, hyt = 0, htt = 0, gx = 0, gy = 0, gt = 0;
  for (const Eigen::Vector2f& p : points_in_scan) {
    const float rx = c * p.x() - s * p.y();
    const float ry = s * p.x() + c * p.y();
    const InterpolatedOccupancy m = map.Interpolate(level, rx + tx, ry + ty);
    const float r = 1.0F - m.value;
    squares += static_cast<double>(r * r);
    occupancy += static_cast<double>(m.value);
    const float jt = m.d_dy * rx - m.d_dx * ry;
    hxx += static_cast<double>(m.d_dx * m.d_dx);
    hxy += static_cast<double>(m.d_dx * m.d_dy);
    hxt += static_cast<double>(m.d_dx * jt);
    hyy += static_cast<double>(m.d_dy * m.d_dy);
    hyt += static_cast<double>(m.d_dy * jt);
    htt += static_cast<double>(jt * jt);
    gx += static_cast<double>(m.d_dx * r);
    gy += static_cast<double>(m.d_dy * r);
    gt += static_cast<double>(jt * r);
  }
  const double weight = 1.0 / (residual_sigma * residual_sigma);
  OccupancyCost result;
  result.cost = 0.5 * weight * squares;
  result.occupancy = occupancy;
  result.gradient = -weight * Eigen::Vector3d(gx, gy, gt);
  result.normal << hxx, hxy, hxt, hxy, hyy, hyt, hxt, hyt, htt;
  result.normal *= weight;
  return result;
}

MatchResult MatchScan(const OccupancyPyramid& map, std::span<const Eigen::Vector2f> points_in_scan, const Pose2& start,
                      const Pose2& predicted, const Eigen::Matrix3d& prediction_covariance,
                      const MatchOptions& options) {
  MatchResult result{.map_from_scan = start};
  if (points_in_scan.empty()) return result;
  const Eigen::Matrix3d prediction_information = prediction_covariance.inverse();
  const auto offset = [&](const Pose2& pose) {
    return Eigen::Vector3d(pose.x - predicted.x, pose.y - predicted.y, NormalizeAngle(pose.theta - predicted.theta));
  };
  const auto total_cost = [&](const OccupancyCost& scan, const Pose2& pose) {
    const Eigen::Vector3d d = offset(pose);
    return scan.cost + 0.5 * d.dot(prediction_information * d);
  };

  Pose2 pose = start;
  OccupancyCost current;
  for (int level = std::min(options.coarsest_level, map.num_levels() - 1); level >= 0; --level) {
    current = EvaluateOccupancyCost(map, level, points_in_scan, pose, options.residual_sigma);
    double cost = total_cost(current, pose);
    double damping = 1e-3;  // Levenberg-Marquardt: bilinear occupancy has kinks at the cell centres
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
      Eigen::Matrix3d normal = current.normal + prediction_information;
      normal.diagonal() *= 1.0 + damping;
      const Eigen::Vector3d gradient = current.gradient + prediction_information * offset(pose);
      const Eigen::Vector3d step = -normal.ldlt().solve(gradient);
      if (!step.allFinite()) return result;
      const Pose2 candidate{pose.x + step.x(), pose.y + step.y(), NormalizeAngle(pose.theta + step.z())};
      const OccupancyCost next = EvaluateOccupancyCost(map, level, points_in_scan, candidate, options.residual_sigma);
      const double next_cost = total_cost(next, candidate);
      const bool small = step.head<2>().norm() < options.step_m && std::abs(step.z()) < options.step_rad;
      if (next_cost < cost) {
        pose = candidate;
        current = next;
        cost = next_cost;
        damping *= 0.3;
      } else {
        damping = std::max(damping, 1e-2) * 8.0;
      }
      if (small) break;
    }
  }
  result.map_from_scan = pose;
  result.information = current.normal;
  result.score = current.occupancy / static_cast<double>(points_in_scan.size());
  const Eigen::LDLT<Eigen::Matrix3d> normal(current.normal + prediction_information);
  if (normal.info() != Eigen::Success || !(normal.vectorD().minCoeff() > 0.0)) return result;
  result.covariance = normal.solve(Eigen::Matrix3d::Identity());
  result.usable = true;
  return result;
}

double MeanOccupancy(const OccupancyPyramid& map, int level, std::span<const Eigen::Vector2f> points_in_scan,
                     const Pose2& map_from_scan) {
  if (points_in_scan.empty()) return 0.0;
  const auto c = static_cast<float>(std::cos(map_from_scan.theta));
  const auto s = static_cast<float>(std::sin(map_from_scan.theta));
  const auto tx = static_cast<float>(map_from_scan.x);
  const auto ty = static_cast<float>(map_from_scan.y);
  double sum = 0;
  for (const Eigen::Vector2f& p : points_in_scan) {
    sum += static_cast<double>(map.Occupancy(level, c * p.x() - s * p.y() + tx, s * p.x() + c * p.y() + ty));
  }
  return sum / static_cast<double>(points_in_scan.size());
}

}  // namespace survey
