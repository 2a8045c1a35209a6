// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/motion_checks.h"

#include <algorithm>

#include "survey/inertial/imu_checks.h"
#include "survey/sensors/odometry_track.h"
#include "survey/sensors/scan_turn.h"

namespace survey {
namespace {

constexpr int kPairs = 60;
constexpr int kFewestVotes = 5;

// Angle about z since the first sample. Biases are small against the turns that are compared.
std::vector<double> IntegratedYaw(const std::vector<ImuSample>& imu) {
  std::vector<double> yaw(imu.size(), 0.0);
  for (std::size_t i = 1; i < imu.size(); ++i) {
    yaw[i] = yaw[i - 1] + 0.5 * Seconds(imu[i].stamp_ns - imu[i - 1].stamp_ns) *
                              (imu[i].angular_rate_in_body.z() + imu[i - 1].angular_rate_in_body.z());
  }
  return yaw;
}

TurnVotes AgainstOdometry(const Session& session) {
  const OdometryTrack odometry(session.odometry, 0.5);
  return CompareScanTurns(
      session,
      [&](StampNs stamp) -> std::optional<double> {
        const std::optional<Pose2> pose = odometry.At(stamp);
        return pose ? std::optional(pose->theta) : std::nullopt;
      },
      kPairs);
}

TurnVotes AgainstGyro(const Session& session) {
  const std::vector<ImuSample> imu = UsableImu(session.imu);
  const std::vector<double> yaw = IntegratedYaw(imu);
  return CompareScanTurns(
      session,
      [&](StampNs stamp) -> std::optional<double> {
        const auto after = std::lower_bound(imu.begin(), imu.end(), stamp,
                                            [](const ImuSample& sample, StampNs t) { return sample.stamp_ns < t; });
        if (after == imu.end()) return std::nullopt;
        return yaw[static_cast<std::size_t>(after - imu.begin())];
      },
      kPairs);
}

void AddTurnFault(const TurnVotes& votes, const std::string& other, std::vector<SessionFault>* faults) {
  if (votes.against < kFewestVotes || votes.against < 5 * votes.with) return;
  faults->push_back({SessionPart::kScans, 0,
                     "the scans turn against the " + other + " (in " + std::to_string(votes.against) + " of " +
                         std::to_string(votes.against + votes.with) +
                         " turns): the lidar is upside down, or its angle_increment has the wrong sign"});
}

}  // namespace

std::vector<SessionFault> CheckMotionSensors(const Session& session) {
  std::vector<SessionFault> faults;
  if (const std::optional<ImuFault> fault = FindImuFault(session.imu, session.odometry))
    faults.push_back({SessionPart::kImu, fault->index, fault->message});
  if (!faults.empty()) return faults;
  if (!session.odometry.empty()) AddTurnFault(AgainstOdometry(session), "odometry", &faults);
  if (faults.empty() && !session.imu.empty()) AddTurnFault(AgainstGyro(session), "gyro", &faults);
  return faults;
}

std::vector<std::string> MotionWarnings(const Session& session) { return ImuWarnings(session.imu); }

}  // namespace survey
