// SPDX-License-Identifier: Apache-2.0
#include "survey/particles/proposal.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "survey/stats/mahalanobis.h"

namespace survey {

double ScanLogLikelihood(const SurfaceMap& map, std::span<const SurfacePoint> points_in_scan,
                         const Pose2& map_from_scan, const ProposalOptions& options) {
  const Eigen::Matrix2f rotation = Rotation2(map_from_scan.theta).cast<float>();
  const Eigen::Vector2f translation = map_from_scan.Translation().cast<float>();
  const double loss_square = options.loss_m * options.loss_m;
  double sum = 0.0;
  for (const SurfacePoint& point : points_in_scan) {
    const Eigen::Vector2f p = rotation * point.position + translation;
    const Eigen::Vector2f normal = rotation * point.normal;
    double square = options.unexplained_m * options.unexplained_m;
    if (const Surfel* surfel = map.Nearest(p, normal)) {
      const Eigen::Vector2f d = p - surfel->mean;
      const float across = surfel->normal.isZero() ? d.norm() : surfel->normal.dot(d);
      square = std::min(square, static_cast<double>(across * across));
    }
    sum += loss_square * std::log1p(square / loss_square);
  }
  return -0.5 * options.match.independent_share * sum / (options.sigma_m * options.sigma_m);
}

Proposal ProposePose(const ParticleMap& map, std::span<const SurfacePoint> points_in_scan, const Pose2& start,
                     Start kind, const Pose2& predicted, const Eigen::Matrix3d& prediction_covariance,
                     const ProposalOptions& options) {
  Proposal proposal{.mean = predicted, .covariance = prediction_covariance};
  const MatchResult match = MatchToSurfaces(kind == Start::kPredicted ? &map.coarse : nullptr, map.fine, points_in_scan,
                                            start, predicted, prediction_covariance, options.match);
  proposal.score = match.score;
  proposal.matched = match.usable && match.score >= options.min_score;
  if (proposal.matched) {
    proposal.mean = match.map_from_scan;
    proposal.covariance = match.covariance;
    const Eigen::Vector3d d(match.map_from_scan.x - predicted.x, match.map_from_scan.y - predicted.y,
                            NormalizeAngle(match.map_from_scan.theta - predicted.theta));
    proposal.log_weight = -0.5 * SquaredMahalanobis(d, prediction_covariance) +
                          0.5 * std::log(match.covariance.determinant() / prediction_covariance.determinant());
  }
  proposal.log_weight += ScanLogLikelihood(map.fine, points_in_scan, proposal.mean, options);
  proposal.log_weight *= options.tempering;
  return proposal;
}

Pose2 SamplePose(const Pose2& mean, const Eigen::Matrix3d& covariance, const Eigen::Vector3d& normals) {
  const Eigen::Vector3d d = covariance.llt().matrixL() * normals;
  return {mean.x + d.x(), mean.y + d.y(), NormalizeAngle(mean.theta + d.z())};
}

}  // namespace survey
