// SPDX-License-Identifier: Apache-2.0
#include <GeographicLib/Constants.hpp>
#include <GeographicLib/NormalGravity.hpp>
#include <cmath>
#include <numbers>

#include "survey/simulation/rig.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The instruments' last digits.
double Rounded(double value) { return std::round(value * 1e7) / 1e7; }
Vector3d Rounded(const Vector3d& v) { return {Rounded(v.x()), Rounded(v.y()), Rounded(v.z())}; }

std::vector<StampNs> StampsOf(const BlockRoute& block, const Trajectory& trajectory, double rate_hz) {
  std::vector<StampNs> stamps;
  for (std::int64_t i = 0;; ++i) {
    const double time = block.start_s + static_cast<double>(i) / rate_hz;
    if (time > trajectory.end_s()) return stamps;
    stamps.push_back(std::llround(time * 1e9));
  }
}

Vector3d NormalVector(const RandomStream& random, std::uint64_t index) {
  const auto [x, y] = random.Normals(2 * index);
  return {x, y, random.Normal(2 * index + 1)};
}

}  // namespace

std::vector<ImuSample> SimulateImu(const Scenario& scenario, const BlockRoute& block, const Trajectory& trajectory) {
  const ImuSpec& imu = scenario.imu;
  const std::uint32_t stream = StreamOfName(block.name);
  const RandomStream bias(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kImuBias), stream);
  const RandomStream noise(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kImuNoise), stream);
  const Vector3d gyro_bias = imu.gyro_bias_sigma_rad_s * NormalVector(bias, 0);
  const Vector3d accelerometer_bias = imu.accelerometer_bias_sigma_m_s2 * NormalVector(bias, 1);
  const double gyro_sigma = imu.gyro_noise_rad_s_rthz * std::sqrt(imu.rate_hz);
  const double accelerometer_sigma = imu.accelerometer_noise_m_s2_rthz * std::sqrt(imu.rate_hz);

  // Plan frame taken as east, north, up.
  const double degrees = imu.latitude_rad * 180.0 / std::numbers::pi;
  const Vector3d gravity(0.0, 0.0, -GeographicLib::NormalGravity::WGS84().SurfaceGravity(degrees));
  const Vector3d earth_rate =
      GeographicLib::Constants::WGS84_omega() * Vector3d(0.0, std::cos(imu.latitude_rad), std::sin(imu.latitude_rad));

  std::vector<ImuSample> samples;
  std::uint64_t index = 0;
  for (const StampNs stamp : StampsOf(block, trajectory, imu.rate_hz)) {
    const double time = Seconds(stamp);
    const MotionState state = trajectory.At(time);
    const Eigen::Matrix3d body_from_plan = state.PlanFromBody().transpose();
    const Vector3d coriolis = 2.0 * earth_rate.cross(trajectory.BodyVelocity(time));
    const Vector3d force = trajectory.BodyAcceleration(time) + coriolis - gravity;
    const Vector3d rate = state.AngularRateInBody() + body_from_plan * earth_rate + gyro_bias +
                          gyro_sigma * NormalVector(noise, 2 * index);
    const Vector3d measured_force =
        body_from_plan * force + accelerometer_bias + accelerometer_sigma * NormalVector(noise, 2 * index + 1);
    samples.push_back(
        {.stamp_ns = stamp, .angular_rate_in_body = Rounded(rate), .specific_force_in_body = Rounded(measured_force)});
    ++index;
  }
  return samples;
}

std::vector<OdometrySample> SimulateOdometry(const Scenario& scenario, const BlockRoute& block,
                                             const Trajectory& trajectory) {
  const OdometrySpec& wheels = scenario.odometry;
  const std::uint32_t stream = StreamOfName(block.name);
  const RandomStream noise(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kOdometry), stream);
  const RandomStream slips(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kSlip), stream);

  std::vector<OdometrySample> samples;
  Pose2 odom_from_body;
  Pose2 before;
  double slip_left_m = 0.0;
  double slip_turn = 0.0;
  std::uint64_t index = 0;
  for (const StampNs stamp : StampsOf(block, trajectory, wheels.rate_hz)) {
    const Pose2 now = trajectory.PlanarPlanFromBody(Seconds(stamp));
    if (index > 0) {
      Pose2 step = Between(before, now);
      const double distance = std::hypot(step.x, step.y);
      const auto [distance_noise, turn_noise] = noise.Normals(index);
      double scale = 1.0 + wheels.scale_error;
      double turn = step.theta * (1.0 + wheels.angular_scale_error) + distance * wheels.angular_drift_rad_per_m +
                    wheels.angular_noise_rad_rtrad * std::sqrt(std::abs(step.theta)) * turn_noise;
      const auto [begins, side] = slips.Uniforms(index);
      if (slip_left_m <= 0.0 && begins < wheels.slips_per_m * distance) {
        slip_left_m = wheels.slip_length_m;
        slip_turn = side < 0.5 ? -wheels.slip_turn_rad_per_m : wheels.slip_turn_rad_per_m;
      }
      if (slip_left_m > 0.0) {
        slip_left_m -= distance;
        scale += wheels.slip_loss;
        turn += slip_turn * distance;
      }
      const double added = wheels.distance_noise_m_rtm * std::sqrt(distance) * distance_noise;
      const double factor = distance > 0.0 ? scale + added / distance : scale;
      step = {factor * step.x, factor * step.y, turn};
      odom_from_body = odom_from_body * step;
    }
    samples.push_back({stamp, {Rounded(odom_from_body.x), Rounded(odom_from_body.y), Rounded(odom_from_body.theta)}});
    before = now;
    ++index;
  }
  return samples;
}

}  // namespace survey
