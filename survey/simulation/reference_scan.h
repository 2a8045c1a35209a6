// SPDX-License-Identifier: Apache-2.0
//
// The terrestrial scanner's reference: one registered cloud in the scanner's own frame, coarse on walls, pillars, cars,
// floor and ceiling, fine on the sphere targets, and the targets' surveyed coordinates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "survey/simulation/ray_caster.h"
#include "survey/simulation/scenario.h"

namespace survey {

// Points in the scanner's frame (m), station by station.
std::vector<Eigen::Vector3f> SimulateReferenceCloud(const Scenario& scenario, const RayCaster& building);

struct SurveyedTarget {
  std::string name;
  Eigen::Vector3d centre_in_site = Eigen::Vector3d::Zero();  // east, north, elevation with the survey's error
};
std::vector<SurveyedTarget> SurveyTargets(const Scenario& scenario);

}  // namespace survey
