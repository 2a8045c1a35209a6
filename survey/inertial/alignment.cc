// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/alignment.h"

#include <cmath>

namespace survey {
namespace {

using Eigen::Vector3d;

bool IsQuiet(const Levelling& window, const QuietOptions& options) {
  return window.rate_sigma.maxCoeff() <= options.max_rate_sigma_rad_s &&
         window.force_sigma.maxCoeff() <= options.max_force_sigma_m_s2 &&
         window.mean_rate_in_body.cwiseAbs().maxCoeff() <= options.max_mean_rate_rad_s;
}

bool Continues(const Levelling& before, const Levelling& now, const QuietOptions& options) {
  return (now.mean_rate_in_body - before.mean_rate_in_body).cwiseAbs().maxCoeff() <= options.max_change_rad_s &&
         (now.mean_force_in_body - before.mean_force_in_body).cwiseAbs().maxCoeff() <= options.max_change_m_s2;
}

}  // namespace

Eigen::Quaterniond LevelFromBody(const Vector3d& force_in_body) {
  const Vector3d up_in_body = force_in_body.normalized();
  // The body's x axis without its vertical part; its y axis where x stands upright.
  Vector3d ahead = Vector3d::UnitX() - up_in_body.x() * up_in_body;
  if (ahead.squaredNorm() < 1e-6) ahead = Vector3d::UnitY() - up_in_body.y() * up_in_body;
  Eigen::Matrix3d level_from_body;
  level_from_body.row(0) = ahead.normalized();
  level_from_body.row(1) = up_in_body.cross(ahead.normalized());
  level_from_body.row(2) = up_in_body;
  return Eigen::Quaterniond(level_from_body).normalized();
}

std::optional<Levelling> Level(std::span<const ImuSample> samples) {
  if (samples.size() < 2) return std::nullopt;
  const double n = static_cast<double>(samples.size());
  Levelling levelling;
  for (const ImuSample& sample : samples) {
    levelling.mean_rate_in_body += sample.angular_rate_in_body / n;
    levelling.mean_force_in_body += sample.specific_force_in_body / n;
  }
  Vector3d rate_squares = Vector3d::Zero();
  Vector3d force_squares = Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    rate_squares += (sample.angular_rate_in_body - levelling.mean_rate_in_body).cwiseAbs2();
    force_squares += (sample.specific_force_in_body - levelling.mean_force_in_body).cwiseAbs2();
  }
  levelling.rate_sigma = (rate_squares / (n - 1.0)).cwiseSqrt();
  levelling.force_sigma = (force_squares / (n - 1.0)).cwiseSqrt();
  levelling.seconds = Seconds(samples.back().stamp_ns - samples.front().stamp_ns);
  if (!(levelling.mean_force_in_body.norm() > 0.0)) return std::nullopt;
  levelling.level_from_body = LevelFromBody(levelling.mean_force_in_body);
  return levelling;
}

std::vector<SampleRange> FindQuiet(std::span<const ImuSample> imu, const QuietOptions& options) {
  std::vector<SampleRange> quiet;
  std::optional<Levelling> before;  // the last window, when it was quiet
  std::size_t begin = 0;
  while (begin < imu.size()) {
    std::size_t end = begin;
    while (end < imu.size() && Seconds(imu[end].stamp_ns - imu[begin].stamp_ns) < options.window_s) ++end;
    std::optional<Levelling> window = Level(imu.subspan(begin, end - begin));
    const bool whole = end < imu.size() && window && window->seconds > 0.5 * options.window_s;
    if (!whole || !IsQuiet(*window, options)) {
      before.reset();
    } else {
      if (before && Continues(*before, *window, options) && quiet.back().end == begin) {
        quiet.back().end = end;
      } else {
        quiet.push_back({begin, end});
      }
      before = window;
    }
    begin = end;
  }
  std::erase_if(quiet, [&](const SampleRange& range) {
    return Seconds(imu[range.end - 1].stamp_ns - imu[range.begin].stamp_ns) < 1.5 * options.window_s;
  });
  return quiet;
}

}  // namespace survey
