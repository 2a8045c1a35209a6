// SPDX-License-Identifier: Apache-2.0
//
// From the solutions of the blocks, the control list and the features found in the maps to the certificate.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "survey/accuracy/certificate.h"
#include "survey/control/control_point.h"
#include "survey/features/feature.h"
#include "survey/graph/solution.h"

namespace survey {

struct CertifiedBlock {
  std::string name;
  Solution solution;
  std::vector<MapFeature> features;   // sought in the block's map
  std::optional<BlockReview> review;  // what a person was asked about it
};

struct CertifyInput {
  std::string site;
  ControlNetwork network;
  std::vector<CertifiedBlock> blocks;
  std::vector<NamedFeature> reference_features;  // independently surveyed
  std::vector<SeamSummary> seams;
  std::optional<double> class_m;
  std::vector<AccuracyClass> classes;  // of standards and contracts, judged beside class_m
  double far_from_control_m = 30.0;    // places farther from used control are named
  double centring_sigma_m = 0.005;     // of the platform over a check point, 1 sigma per axis
};

// What makes the checks dependent on the control, or the inputs contradict each other; empty when all is well.
// A certificate must not be made when this is not empty.
std::vector<std::string> FindContradictions(const CertifyInput& input);

Certificate Certify(const CertifyInput& input);

}  // namespace survey
