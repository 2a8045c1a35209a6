// SPDX-License-Identifier: Apache-2.0
//
// The mechanization on motions whose rates are exact: errors, and how they shrink with the step.
#include "survey/inertial/strapdown.h"

#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/support/inertial_truth.h"

namespace survey {
namespace {

using Eigen::Vector3d;
using test_support::ErrorOf;
using test_support::Motion;
using test_support::MotionOfTime;
using test_support::NavigationError;
using test_support::Place;
using test_support::Reckon;
using test_support::SetAttitude;

constexpr Place kStart{0.88, 0.15, 100.0};

// A cart on a circle: the twist in the body is constant.
Motion ConstantTwist(double t) {
  constexpr double kRate = 0.8;
  Motion motion;
  SetAttitude({0, 0, kRate * t}, {0, 0, kRate}, &motion);
  motion.v = motion.nav_from_body * Vector3d(1.2, 0.3, 0.0);
  motion.dv = kRate * Vector3d::UnitZ().cross(motion.v);
  return motion;
}

// Acceleration along a curve with the platform pitching, rolling and turning.
Motion Accelerating(double t) {
  Motion motion;
  SetAttitude({0.10 * std::sin(2.0 * t), 0.08 * std::cos(1.4 * t), 0.5 * t},
              {0.20 * std::cos(2.0 * t), -0.112 * std::sin(1.4 * t), 0.5}, &motion);
  motion.v = {0.6 * t, 2.0 * std::sin(0.7 * t), 0.2 * std::cos(t)};
  motion.dv = {0.6, 1.4 * std::cos(0.7 * t), -0.2 * std::sin(t)};
  return motion;
}

// Classical coning and sculling: the axis of a tilt goes round at 5 Hz while the platform shakes in step with it.
Motion Coning(double t) {
  constexpr double kTilt = 0.02;
  constexpr double kOmega = 2.0 * std::numbers::pi * 5.0;
  Motion motion;
  SetAttitude(kTilt * Vector3d(std::cos(kOmega * t), std::sin(kOmega * t), 0.0),
              kTilt * kOmega * Vector3d(-std::sin(kOmega * t), std::cos(kOmega * t), 0.0), &motion);
  motion.v = Vector3d(0.0, 0.05 * std::sin(kOmega * t), 0.0);
  motion.dv = Vector3d(0.0, 0.05 * kOmega * std::cos(kOmega * t), 0.0);
  return motion;
}

// Orders of convergence between a step and half of it.
struct Orders {
  double position = 0.0;
  double velocity = 0.0;
  double attitude = 0.0;
};
Orders OrdersOf(const NavigationError& whole, const NavigationError& half) {
  return {std::log2(whole.position_m / half.position_m), std::log2(whole.velocity_m_s / half.velocity_m_s),
          std::log2(whole.attitude_rad / half.attitude_rad)};
}

TEST(StrapdownTest, PositionQuaternionIsTheGeodeticPlace) {
  for (const double latitude : {-1.2, 0.0, 0.7, 1.5}) {
    for (const double longitude : {-3.0, 0.0, 0.4, 2.5}) {
      const Eigen::Quaterniond rotation = EcefFromNav({latitude, longitude});
      const GeodeticPlace place = PlaceOf(rotation);
      EXPECT_NEAR(place.latitude_rad, latitude, 1e-14);
      EXPECT_NEAR(place.longitude_rad, longitude, 1e-14);
      std::vector<double> axes(9);
      double x, y, z;
      constexpr double kDegrees = 180.0 / std::numbers::pi;
      GeographicLib::Geocentric::WGS84().Forward(latitude * kDegrees, longitude * kDegrees, 0.0, x, y, z, axes);
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(rotation.toRotationMatrix()(i / 3, i % 3), axes[static_cast<std::size_t>(i)], 1e-14);
    }
  }
}

TEST(StrapdownTest, RotationVectorsComeBack) {
  for (const double angle : {0.0, 1e-12, 1e-5, 0.3, 3.0}) {
    const Vector3d phi = angle * Vector3d(0.6, -0.64, 0.48);
    EXPECT_LT((ToRotationVector(FromRotationVector(phi)) - phi).norm(), 1e-14 + 1e-12 * angle);
    EXPECT_NEAR(FromRotationVector(phi).norm(), 1.0, 1e-15);
  }
}

TEST(StrapdownTest, AtRestItStaysAtRest) {
  const MotionOfTime rest = [](double) {
    Motion motion;
    SetAttitude({0.02, -0.03, 0.9}, Vector3d::Zero(), &motion);
    return motion;
  };
  const NavigationError error = ErrorOf(Reckon(rest, kStart, 0.0, 600.0, 0.05));
  EXPECT_LT(error.position_m, 1e-4);
  EXPECT_LT(error.velocity_m_s, 1e-6);
  EXPECT_LT(error.attitude_rad, 1e-10);
}

TEST(StrapdownTest, AtWalkingPaceItFollowsExactMotion) {
  const NavigationError twist = ErrorOf(Reckon(ConstantTwist, kStart, 0.0, 60.0, 0.005));
  EXPECT_LT(twist.position_m, 3e-4);
  EXPECT_LT(twist.velocity_m_s, 1e-5);
  EXPECT_LT(twist.attitude_rad, 1e-9);
  const NavigationError accelerating = ErrorOf(Reckon(Accelerating, kStart, 0.0, 60.0, 0.005));
  EXPECT_LT(accelerating.position_m, 2e-3);
  EXPECT_LT(accelerating.velocity_m_s, 1e-4);
  EXPECT_LT(accelerating.attitude_rad, 1e-7);
}

TEST(StrapdownTest, HalvedStepsShowTheOrder) {
  struct Case {
    const char* name;
    MotionOfTime motion;
  };
  for (const Case& c : {Case{"constant twist", ConstantTwist}, Case{"accelerating", Accelerating}}) {
    NavigationError coarse = ErrorOf(Reckon(c.motion, kStart, 0.0, 20.0, 0.08));
    for (const double step : {0.04, 0.02}) {
      const NavigationError fine = ErrorOf(Reckon(c.motion, kStart, 0.0, 20.0, step));
      const Orders orders = OrdersOf(coarse, fine);
      std::printf("%s, %.0f ms: %.1e m, %.1e m/s, %.1e rad; orders %.1f %.1f %.1f\n", c.name, 1e3 * step,
                  fine.position_m, fine.velocity_m_s, fine.attitude_rad, orders.position, orders.velocity,
                  orders.attitude);
      EXPECT_GT(orders.position, 1.9);
      EXPECT_GT(orders.velocity, 2.9);
      EXPECT_GT(orders.attitude, 2.9);
      coarse = fine;
    }
  }
}

TEST(StrapdownTest, ConingAndScullingAreOfFourthOrder) {
  const NavigationError whole = ErrorOf(Reckon(Coning, kStart, 0.0, 10.0, 0.01));
  const NavigationError half = ErrorOf(Reckon(Coning, kStart, 0.0, 10.0, 0.005));
  EXPECT_GT(OrdersOf(whole, half).attitude, 3.0) << whole.attitude_rad << " " << half.attitude_rad;
  EXPECT_LT(half.attitude_rad, 2e-6);
  // Without the products of neighbouring increments the attitude drifts about the cone's axis.
  Eigen::Quaterniond plain = Coning(0.0).nav_from_body;
  for (int i = 0; i < 2000; ++i) {
    const ImuIncrement now = test_support::ExactIncrement(Coning, kStart, i * 0.005, (i + 1) * 0.005, 0.005);
    plain = UpdateAttitude(plain, 0.005 * EarthAt(kStart.latitude_rad, kStart.height_m).rotation_in_nav, {}, now);
  }
  const double drift = ToRotationVector(plain * Coning(10.0).nav_from_body.conjugate()).norm();
  EXPECT_GT(drift, 50.0 * half.attitude_rad);
}

}  // namespace
}  // namespace survey
