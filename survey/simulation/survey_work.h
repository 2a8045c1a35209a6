// SPDX-License-Identifier: Apache-2.0
//
// What the surveyors of a scenario bring home besides the block's logs: coordinates of control, check points and
// features with their errors. Site frame.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/simulation/scenario.h"

namespace survey {

// Truth plus the survey's error, rounded to 0.1 mm; elevations are those of the floor.
std::vector<ControlPoint> SurveyControl(const Scenario& scenario);

struct SurveyedFeature {
  FeaturePoint feature;  // position: truth in the plan frame
  Eigen::Vector2d surveyed_in_site = Eigen::Vector2d::Zero();
};
std::vector<SurveyedFeature> SurveyFeatures(const Scenario& scenario);

}  // namespace survey
