// SPDX-License-Identifier: Apache-2.0
//
// The mechanization on published motion profiles with exact truth at 100 Hz ([Groves13], "strapdown" data): at
// rest, a jittery start, a car, an aircraft, a boat in waves. Splines through the truth make the motion continuous;
// increments are integrated from their derivatives.
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstdio>
#include <numbers>
#include <sstream>
#include <string>

#include "survey/geometry/pose2.h"
#include "survey/inertial/strapdown.h"
#include "tests/support/inertial_truth.h"
#include "tests/support/real_data.h"

namespace survey {
namespace {

using Eigen::Vector3d;
using test_support::Motion;

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kStep_s = 0.01;
using Row =
    std::array<double, 10>;  // s; latitude, longitude (deg), height; v north, east, down; roll, pitch, yaw (deg)

std::vector<Row> ReadProfile(const std::string& file) {
  std::vector<Row> rows;
  gzFile input = gzopen(file.c_str(), "rb");
  std::array<char, 512> line{};
  while (gzgets(input, line.data(), static_cast<int>(line.size())) != nullptr) {
    std::istringstream text(line.data());
    Row row{};
    for (double& value : row) {
      text >> value;
      text.ignore();
    }
    rows.push_back(row);
  }
  gzclose(input);
  return rows;
}

// Natural cubic spline through values at equal steps.
class Spline {
 public:
  explicit Spline(std::vector<double> values) : values_(std::move(values)), bends_(values_.size(), 0.0) {
    const std::size_t n = values_.size();
    std::vector<double> factor(n, 0.0);
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const double pivot = 4.0 - factor[i - 1];
      factor[i] = 1.0 / pivot;
      bends_[i] = (6.0 * (values_[i + 1] - 2.0 * values_[i] + values_[i - 1]) - bends_[i - 1]) / pivot;
    }
    for (std::size_t i = n - 2; i > 0; --i) bends_[i] -= factor[i] * bends_[i + 1];
  }
  // Value and derivative.
  std::pair<double, double> At(double time_s) const {
    const double where = std::clamp(time_s / kStep_s, 0.0, static_cast<double>(values_.size() - 1));
    const std::size_t i = std::min(static_cast<std::size_t>(where), values_.size() - 2);
    const double u = where - static_cast<double>(i);
    const double w = 1.0 - u;
    const double value =
        w * values_[i] + u * values_[i + 1] + (w * w * w - w) / 6.0 * bends_[i] + (u * u * u - u) / 6.0 * bends_[i + 1];
    const double slope =
        values_[i + 1] - values_[i] - (3 * w * w - 1) / 6.0 * bends_[i] + (3 * u * u - 1) / 6.0 * bends_[i + 1];
    return {value, slope / kStep_s};
  }

 private:
  std::vector<double> values_;
  std::vector<double> bends_;  // second derivatives times step squared
};

// Continuous motion through a profile, in our axes.
class ProfileMotion {
 public:
  explicit ProfileMotion(const std::vector<Row>& rows) {
    for (std::size_t column = 4; column < 10; ++column) {
      std::vector<double> values;
      for (const Row& row : rows) {
        double value = row[column];
        if (column >= 7) {
          value *= kRadians;
          if (!values.empty()) value = values.back() + NormalizeAngle(value - values.back());
        }
        values.push_back(value);
      }
      splines_.emplace_back(std::move(values));
    }
  }

  Motion operator()(double time_s) const {
    std::array<double, 6> value{};
    std::array<double, 6> slope{};
    for (std::size_t i = 0; i < 6; ++i) std::tie(value[i], slope[i]) = splines_[i].At(time_s);
    Motion motion;
    motion.v = {value[1], value[0], -value[2]};
    motion.dv = {slope[1], slope[0], -slope[2]};
    // North-east-down and forward-right-down by yaw, pitch, roll; ours differ by fixed half turns.
    using Eigen::AngleAxisd;
    const Eigen::Quaterniond ned_from_frd = AngleAxisd(value[5], Vector3d::UnitZ()) *
                                            AngleAxisd(value[4], Vector3d::UnitY()) *
                                            AngleAxisd(value[3], Vector3d::UnitX());
    const Eigen::Quaterniond enu_from_ned(0.0, std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0, 0.0);
    const Eigen::Quaterniond frd_from_flu(0.0, 1.0, 0.0, 0.0);
    motion.nav_from_body = enu_from_ned * ned_from_frd * frd_from_flu;
    const double sr = std::sin(value[3]), cr = std::cos(value[3]);
    const double sp = std::sin(value[4]), cp = std::cos(value[4]);
    const Vector3d rate(slope[3] - sp * slope[5], cr * slope[4] + sr * cp * slope[5],
                        -sr * slope[4] + cr * cp * slope[5]);
    motion.rate_in_body = {rate.x(), -rate.y(), -rate.z()};
    return motion;
  }

 private:
  std::vector<Spline> splines_;
};

struct Bound {
  int profile;
  double position_m;  // at the end, at 100 Hz
  double velocity_m_s;
  double attitude_rad;
};
void PrintTo(const Bound& bound, std::ostream* out) { *out << "profile " << bound.profile; }

class MotionProfiles : public testing::TestWithParam<Bound> {};

TEST_P(MotionProfiles, ErrorsAtTheEnd) {
  const Bound& bound = GetParam();
  const auto file = test_support::RealData("strapdown/Profile_" + std::to_string(bound.profile) + ".csv.gz");
  if (!file) GTEST_SKIP() << "shared data set strapdown/ not found";
  const std::vector<Row> rows = ReadProfile(file->string());
  ASSERT_GT(rows.size(), 1000U);
  const ProfileMotion motion(rows);
  const test_support::Place start{rows[0][1] * kRadians, rows[0][2] * kRadians, rows[0][3]};
  const double end = kStep_s * static_cast<double>(rows.size() - 1);
  const auto at_100_hz = test_support::Reckon(motion, start, 0.0, end, kStep_s);
  const auto at_200_hz = test_support::Reckon(motion, start, 0.0, end, kStep_s / 2);
  const test_support::NavigationError whole = ErrorOf(at_100_hz);
  const test_support::NavigationError half = ErrorOf(at_200_hz);
  const double to_file =
      std::hypot((PlaceOf(at_100_hz.state.ecef_from_nav).latitude_rad - rows.back()[1] * kRadians) *
                     EarthAt(start.latitude_rad, start.height_m).meridian_radius_m,
                 (PlaceOf(at_100_hz.state.ecef_from_nav).longitude_rad - rows.back()[2] * kRadians) *
                     EarthAt(start.latitude_rad, start.height_m).transverse_radius_m * std::cos(start.latitude_rad));
  std::printf(
      "profile %d, %.0f s: 100 Hz %.1e m %.1e m/s %.1e rad; 200 Hz %.1e m %.1e m/s %.1e rad; from the file's place "
      "%.3f m\n",
      bound.profile, end, whole.position_m, whole.velocity_m_s, whole.attitude_rad, half.position_m, half.velocity_m_s,
      half.attitude_rad, to_file);
  EXPECT_LT(whole.position_m, bound.position_m);
  EXPECT_LT(whole.velocity_m_s, bound.velocity_m_s);
  EXPECT_LT(whole.attitude_rad, bound.attitude_rad);
  EXPECT_LT(half.position_m, 0.3 * whole.position_m + 2e-5);
  EXPECT_LT(half.velocity_m_s, 0.3 * whole.velocity_m_s + 1e-6);
  EXPECT_LT(half.attitude_rad, 0.3 * whole.attitude_rad + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Published, MotionProfiles,
                         testing::Values(Bound{0, 2e-5, 1e-9, 1e-11},  // at rest
                                         Bound{1, 3e-4, 1e-5, 3e-8}, Bound{2, 3e-4, 3e-6, 1e-10},
                                         Bound{3, 5e-3, 4e-5, 1e-8}, Bound{4, 5e-2, 2e-4, 1e-8}));

}  // namespace
}  // namespace survey
