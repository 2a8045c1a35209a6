// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/survey_work.h"

#include <cmath>

#include "survey/stats/philox.h"

namespace survey {
namespace {

// The same point gets the same error whatever else is in the list.
Eigen::Vector2d Surveyed(const Scenario& scenario, SimulationPurpose purpose, const std::string& name,
                         const Eigen::Vector2d& p_in_plan, double sigma_m) {
  const RandomStream random(scenario.seed, static_cast<std::uint32_t>(purpose), StreamOfName(name));
  const auto [east, north] = random.Normals(0);
  const Eigen::Vector2d p_in_site = scenario.SiteOf(p_in_plan) + sigma_m * Eigen::Vector2d(east, north);
  return (p_in_site * 1e4).array().round().matrix() / 1e4;
}

}  // namespace

std::vector<ControlPoint> SurveyControl(const Scenario& scenario) {
  const double variance = scenario.control_sigma_m * scenario.control_sigma_m;
  std::vector<ControlPoint> points;
  for (const LandmarkPoint& point : scenario.points) {
    points.push_back({.name = point.name,
                      .role = point.role,
                      .position_in_site = Surveyed(scenario, SimulationPurpose::kControlSurvey, point.name,
                                                   point.position, scenario.control_sigma_m),
                      .covariance = Eigen::Vector2d::Constant(variance).asDiagonal(),
                      .elevation_m = scenario.elevation_m,
                      .description = point.description});
  }
  return points;
}

std::vector<SurveyedFeature> SurveyFeatures(const Scenario& scenario) {
  std::vector<SurveyedFeature> features;
  for (const FeaturePoint& feature : scenario.features) {
    features.push_back({feature, Surveyed(scenario, SimulationPurpose::kFeatureSurvey, feature.name, feature.position,
                                          scenario.feature_sigma_m)});
  }
  return features;
}

}  // namespace survey
