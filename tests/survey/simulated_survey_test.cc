// SPDX-License-Identifier: Apache-2.0
//
// Surveyed coordinates and the terrestrial scanner's cloud.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "survey/simulation/reference_scan.h"
#include "survey/simulation/survey_work.h"
#include "tests/support/room_scenario.h"

namespace survey {
namespace {

using Eigen::Vector3d;

TEST(SurveyWork, CoordinatesHaveTheSurveysErrorPointByPoint) {
  Scenario scenario = test_support::RoomScenario();
  scenario.control_sigma_m = 0.004;
  scenario.points.clear();
  for (int i = 0; i < 500; ++i)
    scenario.points.push_back({.name = "P" + std::to_string(i), .position = {0.1 * i, 0.2 * i}});
  const std::vector<ControlPoint> surveyed = SurveyControl(scenario);
  ASSERT_EQ(surveyed.size(), 500U);
  double squares = 0.0;
  for (std::size_t i = 0; i < surveyed.size(); ++i) {
    squares += (surveyed[i].position_in_site - scenario.SiteOf(scenario.points[i].position)).squaredNorm();
    EXPECT_DOUBLE_EQ(surveyed[i].covariance(0, 0), 0.004 * 0.004);
  }
  EXPECT_NEAR(std::sqrt(squares / 1000), 0.004, 5 * 0.004 / std::sqrt(2000.0));

  // A point that is no longer in the list changes nobody else's error.
  scenario.points.erase(scenario.points.begin());
  EXPECT_EQ(SurveyControl(scenario)[7].position_in_site, surveyed[8].position_in_site);
}

// Centre and radius of the sphere through points by linear least squares.
Eigen::Vector4d FitSphere(const std::vector<Vector3d>& points) {
  Eigen::MatrixXd a(points.size(), 4);
  Eigen::VectorXd b(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    a.row(row) << 2 * points[i].transpose(), 1.0;
    b[row] = points[i].squaredNorm();
  }
  const Eigen::Vector4d x = a.colPivHouseholderQr().solve(b);
  return {x[0], x[1], x[2], std::sqrt(x[3] + x.head<3>().squaredNorm())};
}

TEST(ReferenceScan, WallsAndSpheresLieWhereTheyShould) {
  Scenario scenario = test_support::RoomScenario();
  ReferenceSpec& reference = scenario.reference;
  reference.stations = {{12.0, 8.0}, {5.0, 5.0}};
  reference.targets = {{"S1", {8.0, 9.0, 0.8}}, {"S2", {15.0, 4.0, 1.7}}};
  reference.step_rad = 0.01;
  reference.scanner_from_plan = {-31.0, 18.0, 1.1};
  reference.scanner_from_plan_z_m = 0.5;
  const std::vector<Eigen::Vector3f> cloud = SimulateReferenceCloud(scenario, RayCaster(BuildFloorPlan(scenario)));
  ASSERT_GT(cloud.size(), 20000U);

  const Pose2 plan_from_cloud = Inverse(reference.scanner_from_plan);
  std::vector<std::vector<Vector3d>> on_sphere(2);
  int elsewhere = 0;
  for (const Eigen::Vector3f& point : cloud) {
    const Eigen::Vector2d planar = plan_from_cloud * Eigen::Vector2d(point.x(), point.y());
    const Vector3d p(planar.x(), planar.y(), static_cast<double>(point.z()) - 0.5);
    const double to_walls = std::min({p.x(), 24.0 - p.x(), p.y(), 16.0 - p.y(), p.z(), reference.ceiling_m - p.z()});
    for (std::size_t i = 0; i < 2; ++i) {
      const double to_sphere = (p - reference.targets[i].centre).norm() - reference.sphere_radius_m;
      if (std::abs(to_sphere) < 0.012) on_sphere[i].push_back(p);
    }
    const bool on_any = std::abs(to_walls) < 0.012 ||
                        std::abs((p - reference.targets[0].centre).norm() - reference.sphere_radius_m) < 0.012 ||
                        std::abs((p - reference.targets[1].centre).norm() - reference.sphere_radius_m) < 0.012;
    elsewhere += on_any ? 0 : 1;
  }
  EXPECT_EQ(elsewhere, 0);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_GT(on_sphere[i].size(), 300U);
    const Eigen::Vector4d fit = FitSphere(on_sphere[i]);
    EXPECT_LT((fit.head<3>() - reference.targets[i].centre).norm(), 0.001);
    EXPECT_NEAR(fit[3], reference.sphere_radius_m, 0.001);
  }

  const std::vector<SurveyedTarget> targets = SurveyTargets(scenario);
  ASSERT_EQ(targets.size(), 2U);
  EXPECT_LT((targets[0].centre_in_site - Vector3d(500008.0, 5600009.0, 0.8)).norm(), 0.02);
}

}  // namespace
}  // namespace survey
