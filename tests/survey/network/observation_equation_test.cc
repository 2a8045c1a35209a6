// SPDX-License-Identifier: Apache-2.0
//
// Observation equations against numerical derivatives, and against values worked by hand.
#include "survey/network/observation_equation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using survey::Observation;
using survey::ObservationEquation;
using survey::ObservationKind;

constexpr double kGon = M_PI / 200.0;

std::vector<Observation> OneOfEachKind() {
  std::vector<Observation> all;
  for (int k = 0; k <= static_cast<int>(ObservationKind::kDifference); ++k) {
    Observation o{.kind = static_cast<ObservationKind>(k), .from = 0, .to = 1, .component = k % 3};
    if (o.kind == ObservationKind::kAngle) o.fore = 2;
    if (o.kind == ObservationKind::kDirection) o.set = 0;
    o.instrument_height = 1.5;
    o.target_height = 0.3;
    all.push_back(o);
  }
  return all;
}

void ExpectDerivatives(const std::vector<Eigen::Vector3d>& positions, const survey::NetworkGeometry& geometry,
                       double tolerance) {
  const double kStep = geometry.geocentric ? 0.05 : 1e-3;
  for (const Observation& o : OneOfEachKind()) {
    const ObservationEquation at = Evaluate(o, positions, 0.4, geometry);
    for (int point = 0; point < 3; ++point) {
      Eigen::RowVector3d analytic = Eigen::RowVector3d::Zero();
      for (std::size_t p = 0; p < static_cast<std::size_t>(at.num_points); ++p) {
        if (at.points[p] == point) analytic += at.partials[p];
      }
      for (int c = 0; c < 3; ++c) {
        auto before = positions, after = positions;
        before[static_cast<std::size_t>(point)][c] -= kStep;
        after[static_cast<std::size_t>(point)][c] += kStep;
        const double numeric =
            (Evaluate(o, after, 0.4, geometry).computed - Evaluate(o, before, 0.4, geometry).computed) / (2 * kStep);
        EXPECT_NEAR(analytic[c], numeric, tolerance) << Name(o.kind) << " point " << point << " component " << c;
      }
    }
    const double by_orientation =
        (Evaluate(o, positions, 0.41, geometry).computed - Evaluate(o, positions, 0.39, geometry).computed) / 0.02;
    EXPECT_NEAR(at.orientation_partial, by_orientation, 1e-9) << Name(o.kind);
  }
}

TEST(ObservationEquationTest, DerivativesInThePlane) {
  ExpectDerivatives({{10, 20, 3}, {45, 61, 8}, {-20, 35, 1}}, {}, 1e-8);
  ExpectDerivatives({{10, 20, 3}, {45, 61, 8}, {-20, 35, 1}}, {.combined_factor = 0.98}, 1e-8);
}

// The levelled axes turn with the station; what that adds to the derivatives is neglected: length of the sight / radius
// of the Earth.
TEST(ObservationEquationTest, DerivativesOnTheEarth) {
  const Eigen::Vector3d a(-4131186.4731, 2897197.7184, -3888283.1408);
  ExpectDerivatives({a, a + Eigen::Vector3d(40, 55, -30), a + Eigen::Vector3d(-20, 60, 25)}, {.geocentric = true},
                    5e-6);
}

double Value(ObservationKind kind, const Eigen::Vector3d& to) {
  const Observation o{.kind = kind, .from = 0, .to = 1, .fore = 2, .set = 0};
  return Evaluate(o, {{100, 200, 50}, to, {100, 300, 50}}, 0.0, {}).computed;
}

TEST(ObservationEquationTest, AnglesAreClockwiseFromNorth) {
  EXPECT_NEAR(Value(ObservationKind::kAzimuth, {130, 240, 50}), std::atan2(3, 4), 1e-14);  // north-east
  EXPECT_NEAR(Value(ObservationKind::kAzimuth, {200, 200, 50}), 100 * kGon, 1e-14);        // east
  EXPECT_NEAR(Value(ObservationKind::kZenithAngle, {130, 240, 100}), 50 * kGon, 1e-14);    // 45 degrees up
  EXPECT_NEAR(Value(ObservationKind::kSlopeDistance, {130, 240, 100}), std::sqrt(5000.0), 1e-12);
  EXPECT_NEAR(Value(ObservationKind::kDistance, {130, 240, 100}), 50.0, 1e-12);
  // From east clockwise to north: three quarters of a circle.
  EXPECT_NEAR(survey::WrappedAngle(Value(ObservationKind::kAngle, {200, 200, 50}) - 300 * kGon), 0.0, 1e-14);
}

TEST(ObservationEquationTest, InstrumentAndTargetHeights) {
  const Observation o{
      .kind = ObservationKind::kZenithAngle, .from = 0, .to = 1, .instrument_height = 1.6, .target_height = 1.1};
  const double computed = Evaluate(o, {{0, 0, 10}, {30, 40, 12}}, 0.0, {}).computed;
  EXPECT_NEAR(computed, std::atan2(50.0, 12 + 1.1 - 10 - 1.6), 1e-14);
}

// On the ground distances are longer than on a grid that shrinks them; heights and angles know no grid.
TEST(ObservationEquationTest, CombinedFactor) {
  const survey::NetworkGeometry geometry{.combined_factor = 0.5};
  const std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {1.5, 2.0, 5.0}};  // 3, 4 and 5 m on the ground
  const auto value = [&](ObservationKind kind) {
    return Evaluate({.kind = kind, .from = 0, .to = 1}, positions, 0.0, geometry).computed;
  };
  EXPECT_NEAR(value(ObservationKind::kDistance), 5.0, 1e-14);
  EXPECT_NEAR(value(ObservationKind::kSlopeDistance), std::sqrt(50.0), 1e-14);
  EXPECT_NEAR(value(ObservationKind::kZenithAngle), M_PI / 4, 1e-14);
  EXPECT_NEAR(value(ObservationKind::kAzimuth), std::atan2(3, 4), 1e-14);
  EXPECT_NEAR(value(ObservationKind::kHeightDifference), 5.0, 1e-14);
}

TEST(ObservationEquationTest, MisclosuresOfAnglesAreSmall) {
  const Observation o{.kind = ObservationKind::kDirection, .value = 399.9999 * kGon};
  EXPECT_NEAR(survey::Misclosure(o, 0.0001 * kGon), -0.0002 * kGon, 1e-12);
  EXPECT_NEAR(survey::Misclosure(o, 800.0001 * kGon), -0.0002 * kGon, 1e-12);
}

}  // namespace
