// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/imu_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numbers>

#include "survey/inertial/alignment.h"

namespace survey {
namespace {

using Eigen::Vector3d;
using Axes = Eigen::Matrix<double, 6, 1>;

constexpr StampNs kStuck = 100'000'000;
constexpr StampNs kLongGap = 500'000'000;
constexpr std::size_t kClippedInARow = 3;
constexpr double kLeastClippedRate = 1.7;    // rad/s: no gyro clips below 100 deg/s
constexpr double kLeastClippedForce = 14.0;  // m/s2: nor an accelerometer below 1.5 g
constexpr std::array<const char*, 6> kAxisNames = {"gyro x",          "gyro y",          "gyro z",
                                                   "accelerometer x", "accelerometer y", "accelerometer z"};

std::string Text(const char* format, ...) {
  char text[320];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

Axes AxesOf(const ImuSample& sample) {
  return (Axes() << sample.angular_rate_in_body, sample.specific_force_in_body).finished();
}

bool IsLost(const ImuSample& sample) {
  return sample.angular_rate_in_body.isZero(0.0) && sample.specific_force_in_body.isZero(0.0);
}

void FindRuns(std::span<const ImuSample> imu, std::vector<UnusableImu>* found) {
  for (std::size_t begin = 0; begin < imu.size();) {
    std::size_t end = begin + 1;
    while (end < imu.size() && AxesOf(imu[end]) == AxesOf(imu[begin])) ++end;
    const bool lost = IsLost(imu[begin]);
    if (lost || imu[end - 1].stamp_ns - imu[begin].stamp_ns >= kStuck)
      found->push_back({lost ? UnusableImu::Cause::kLostPackets : UnusableImu::Cause::kStuck, "", 0.0, begin, end});
    begin = end;
  }
}

void FindClipped(std::span<const ImuSample> imu, std::vector<UnusableImu>* found) {
  Axes largest = Axes::Zero();
  for (const ImuSample& sample : imu) largest = largest.cwiseMax(AxesOf(sample).cwiseAbs());
  for (int axis = 0; axis < 6; ++axis) {
    if (largest(axis) < (axis < 3 ? kLeastClippedRate : kLeastClippedForce)) continue;
    const auto clips = [&](std::size_t i) { return std::abs(AxesOf(imu[i])(axis)) == largest(axis); };
    for (std::size_t begin = 0; begin < imu.size(); ++begin) {
      if (!clips(begin)) continue;
      std::size_t end = begin + 1;
      while (end < imu.size() && clips(end)) ++end;
      if (end - begin >= kClippedInARow)
        found->push_back(
            {UnusableImu::Cause::kSaturated, kAxisNames[static_cast<std::size_t>(axis)], largest(axis), begin, end});
      begin = end;
    }
  }
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Component by component: a drive accelerates to and fro, gravity stays.
Vector3d MedianForce(const std::vector<ImuSample>& imu) {
  Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const ImuSample& sample : imu) values.push_back(sample.specific_force_in_body(axis));
    median(axis) = Median(std::move(values));
  }
  return median;
}

std::optional<std::string> ForceFault(const std::vector<ImuSample>& imu) {
  const Vector3d force = MedianForce(imu);
  const double size = force.norm();
  const std::string wanted = ": the specific force is wanted in m/s2 with gravity, +9.8 on z at rest";
  if (size > 0.8 && size < 1.25) return Text("the accelerometers read %.3f at rest, which is g", size) + wanted;
  if (size > 800.0 && size < 1250.0) return Text("the accelerometers read %.0f at rest, which is mg", size) + wanted;
  if (size < 0.8) return Text("the accelerometers read %.3f at rest: gravity was taken out", size) + wanted;
  if (size < 8.8 || size > 10.8)
    return Text("the accelerometers read %.2f at rest, which is not gravity", size) + wanted;
  int axis = 0;
  const double share = force.cwiseAbs().maxCoeff(&axis) / size;
  const char letter = "xyz"[axis];
  const char* axes = ": the body's axes are x forward, y left, z up, and z reads +9.8 at rest";
  if (share < 0.8) return std::nullopt;  // far from level: a warning
  if (axis != 2)
    return Text("gravity shows on %c (%+.2f m/s2), the IMU's axes are exchanged", letter, force(axis)) + axes;
  if (force.z() < 0.0)
    return Text("gravity shows as %+.2f m/s2 on z, the IMU is upside down or its z axis points down", force.z()) + axes;
  return std::nullopt;
}

std::optional<std::string> RateSizeFault(const std::vector<ImuSample>& imu) {
  constexpr double kTooFast = 8.0;  // rad/s, 460 deg/s
  std::vector<double> rates;
  for (const ImuSample& sample : imu) rates.push_back(sample.angular_rate_in_body.norm());
  const auto high = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() * 98 / 100);
  std::nth_element(rates.begin(), high, rates.end());
  if (*high < kTooFast) return std::nullopt;
  return Text(
      "the gyros read more than %.0f for a fiftieth of the time: in rad/s no platform turns like that, they look "
      "like deg/s; rad/s are wanted",
      std::floor(*high));
}

// Turns about z by gyro and by odometry over the intervals of the odometry, thinned to half a second.
struct Turns {
  double products = 0.0;
  double squares_odometry = 0.0;
  double squares_gyro = 0.0;
};

Turns CompareTurns(const std::vector<ImuSample>& imu, std::span<const OdometrySample> odometry, double bias) {
  constexpr StampNs kInterval = 500'000'000;
  Turns turns;
  std::size_t next = 0;
  for (std::size_t from = 0; from < odometry.size();) {
    std::size_t to = from + 1;
    double turn = 0.0;  // not wrapped: interval by interval
    while (to < odometry.size()) {
      turn += NormalizeAngle(odometry[to].odom_from_body.theta - odometry[to - 1].odom_from_body.theta);
      if (odometry[to].stamp_ns - odometry[from].stamp_ns >= kInterval) break;
      ++to;
    }
    if (to >= odometry.size()) break;
    while (next + 1 < imu.size() && imu[next + 1].stamp_ns < odometry[from].stamp_ns) ++next;
    double integral = 0.0;
    double covered = 0.0;
    for (std::size_t i = next; i + 1 < imu.size() && imu[i].stamp_ns < odometry[to].stamp_ns; ++i) {
      const double dt = Seconds(imu[i + 1].stamp_ns - imu[i].stamp_ns);
      integral += dt * (0.5 * (imu[i].angular_rate_in_body.z() + imu[i + 1].angular_rate_in_body.z()) - bias);
      covered += dt < 0.2 ? dt : 0.0;
    }
    const double wanted = Seconds(odometry[to].stamp_ns - odometry[from].stamp_ns);
    if (covered > 0.9 * wanted && wanted < 2.0) {
      turns.products += integral * turn;
      turns.squares_odometry += turn * turn;
      turns.squares_gyro += integral * integral;
    }
    from = to;
  }
  return turns;
}

std::optional<std::string> TurnFault(const std::vector<ImuSample>& imu, std::span<const OdometrySample> odometry) {
  constexpr double kEnough_rad2 = 0.1;
  std::vector<double> rates;
  for (const ImuSample& sample : imu) rates.push_back(sample.angular_rate_in_body.z());
  const Turns turns = CompareTurns(imu, odometry, Median(rates));
  if (turns.squares_odometry < kEnough_rad2) return std::nullopt;
  const double slope = turns.products / turns.squares_odometry;
  const double correlation = turns.products / std::sqrt(turns.squares_odometry * turns.squares_gyro + 1e-12);
  if (correlation > 0.8 && slope > 30.0 && slope < 90.0)
    return Text("the gyros turn %.1f times as fast as the odometry: they look like deg/s; rad/s are wanted", slope);
  if (correlation < -0.8)
    return Text(
        "the gyro about z turns against the odometry (%.2f): x forward, y left, z up, counter-clockwise positive "
        "is wanted of both",
        slope);
  return std::nullopt;
}

const char* NameOf(UnusableImu::Cause cause) {
  switch (cause) {
    case UnusableImu::Cause::kLostPackets:
      return "all zero (lost packets)";
    case UnusableImu::Cause::kStuck:
      return "stuck (the same six values)";
    case UnusableImu::Cause::kSaturated:
      return "saturated";
  }
  return "";
}

}  // namespace

std::vector<UnusableImu> FindUnusable(std::span<const ImuSample> imu) {
  std::vector<UnusableImu> found;
  FindRuns(imu, &found);
  FindClipped(imu, &found);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
  return found;
}

std::vector<ImuSample> UsableImu(std::span<const ImuSample> imu) {
  std::vector<ImuSample> usable;
  usable.reserve(imu.size());
  std::size_t next = 0;
  for (const UnusableImu& stretch : FindUnusable(imu)) {
    for (; next < stretch.begin; ++next) usable.push_back(imu[next]);
    next = std::max(next, stretch.end);
  }
  for (; next < imu.size(); ++next) usable.push_back(imu[next]);
  return usable;
}

std::optional<ImuFault> FindImuFault(std::span<const ImuSample> imu, std::span<const OdometrySample> odometry) {
  constexpr std::size_t kFewest = 50;
  const std::vector<ImuSample> usable = UsableImu(imu);
  if (usable.size() < kFewest) return std::nullopt;  // too little to judge; and too little to be used
  for (const std::optional<std::string>& message :
       {ForceFault(usable), RateSizeFault(usable), TurnFault(usable, odometry)}) {
    if (message) return ImuFault{0, *message};
  }
  return std::nullopt;
}

std::vector<std::string> ImuWarnings(std::span<const ImuSample> imu) {
  std::vector<std::string> warnings;
  struct Sum {
    std::size_t samples = 0;
    std::size_t stretches = 0;
    const UnusableImu* longest = nullptr;
  };
  std::array<Sum, 3> sums;
  const std::vector<UnusableImu> unusable = FindUnusable(imu);
  for (const UnusableImu& stretch : unusable) {
    Sum& sum = sums[static_cast<std::size_t>(stretch.cause)];
    sum.samples += stretch.end - stretch.begin;
    ++sum.stretches;
    if (sum.longest == nullptr || stretch.end - stretch.begin > sum.longest->end - sum.longest->begin)
      sum.longest = &stretch;
  }
  for (const Sum& sum : sums) {
    if (sum.stretches == 0) continue;
    const UnusableImu& longest = *sum.longest;
    std::string text =
        Text("IMU: %zu samples in %zu stretches are %s", sum.samples, sum.stretches, NameOf(longest.cause));
    if (!longest.axis.empty()) text += Text(" (%s at %.4g)", longest.axis.c_str(), longest.value);
    warnings.push_back(text + Text(", the longest from %.3f to %.3f: left out", Seconds(imu[longest.begin].stamp_ns),
                                   Seconds(imu[longest.end - 1].stamp_ns)));
  }
  const std::vector<ImuSample> usable = UsableImu(imu);
  std::size_t gaps = 0;
  std::size_t widest = 0;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    if (imu[i].stamp_ns - imu[i - 1].stamp_ns <= kLongGap) continue;
    ++gaps;
    if (widest == 0 || imu[i].stamp_ns - imu[i - 1].stamp_ns > imu[widest].stamp_ns - imu[widest - 1].stamp_ns)
      widest = i;
  }
  if (gaps > 0) {
    warnings.push_back(Text("IMU: %zu gaps of more than %.1f s, the longest of %.1f s after %.3f", gaps,
                            Seconds(kLongGap), Seconds(imu[widest].stamp_ns - imu[widest - 1].stamp_ns),
                            Seconds(imu[widest - 1].stamp_ns)));
  }
  if (!usable.empty()) {
    const Vector3d force = MedianForce(usable);
    const double tilt = std::atan2(force.head<2>().norm(), force.z());
    if (force.norm() > 8.8 && tilt > 0.17)
      warnings.push_back(
          Text("IMU: tilted by %.0f degrees against the vertical at rest; scans are taken to lie in its "
               "x-y plane",
               tilt * 180.0 / std::numbers::pi));
  }
  return warnings;
}

}  // namespace survey
