// SPDX-License-Identifier: Apache-2.0
//
// An urban network of 1,182 measurements on the ellipsoid (angles, slope distances, zenith angles, levelling, GNSS
// baselines and positions) against DynAdjust's expected adjustment.
#include <gtest/gtest.h>

#include <cmath>

#include "survey/network/adjustment.h"
#include "survey/network/observation_equation.h"
#include "tests/support/dynadjust_files.h"
#include "tests/support/real_data.h"

namespace {

constexpr double kArcSecond = M_PI / 180.0 / 3600.0;

// Coordinates, residuals and sigmas are printed to 0.1 mm: the bounds are hardly more than that.
void ExpectExpected(const test_support::DynAdjustNetwork& data, const survey::NetworkAdjustment& ours) {
  ASSERT_TRUE(ours.usable) << ours.message;
  double farthest = 0.0;
  for (std::size_t i = 0; i < ours.points.size(); ++i) {
    const Eigen::Vector3d difference = ours.points[i].position - data.expected_positions[i];
    farthest = std::max(farthest, difference.norm());
    EXPECT_LT(difference.norm(), 1e-4) << data.network.points[i].name;
    const Eigen::Matrix3d axes = survey::LevelledAxes(ours.points[i].position);
    const Eigen::Matrix3d covariance = axes * ours.points[i].covariance * axes.transpose();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(std::sqrt(std::max(0.0, covariance(k, k))), data.expected_sigmas[i][k], 1e-4)
          << data.network.points[i].name;
    }
  }
  testing::Test::RecordProperty("farthest_point_m", std::to_string(farthest));
  EXPECT_EQ(ours.degrees_of_freedom - data.num_loose_constraints, data.degrees_of_freedom);
  EXPECT_NEAR(ours.chi_square, data.chi_square, 1e-4 * data.chi_square);
  for (std::size_t k = 0; k < data.expected.size(); ++k) {
    const test_support::ExpectedMeasurement& expected = data.expected[k];
    if (expected.type == 'Y') continue;  // there in latitude and longitude
    const survey::ObservationResult& result = ours.observations[k];
    const bool angular = survey::IsAngular(data.network.observations[k].kind);
    const double unit = angular ? kArcSecond : 1.0, tolerance = angular ? 0.03 : 1.0e-4;
    const double sign = expected.type == 'Z' ? -1.0 : 1.0;  // height angles
    std::string name(1, expected.type);
    for (const std::string& station : expected.stations) name += " " + station;
    EXPECT_NEAR(sign * result.residual / unit, expected.correction, tolerance) << name;
    EXPECT_NEAR(result.sigma_adjusted / unit, expected.sigma_adjusted, tolerance) << name;
    if (result.redundancy < 0.01) continue;  // DynAdjust divides by a deviation of few digits
    EXPECT_NEAR(sign * result.Standardized(), expected.n_statistic, 0.05) << name;
  }
}

TEST(DynAdjustNetworkTest, UrbanNetwork) {
  const auto folder = test_support::RealData("dynadjust");
  if (!folder) GTEST_SKIP() << "no data in ../shared/data/dynadjust";
  const test_support::DynAdjustNetwork data = test_support::ReadDynAdjust(*folder);
  EXPECT_LT(data.geoid_misfit, 1.2e-4);  // the difference of two rounded heights, and the surface
  for (const survey::NetworkSolver solver : {survey::NetworkSolver::kSparse, survey::NetworkSolver::kDense}) {
    SCOPED_TRACE(solver == survey::NetworkSolver::kSparse ? "sparse" : "dense");
    ExpectExpected(data, AdjustNetwork(data.network, {.solver = solver}));
  }
}

}  // namespace
