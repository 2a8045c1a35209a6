// SPDX-License-Identifier: Apache-2.0
//
// From an adjusted network to the control points that tie maps.
#pragma once

#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/network/adjustment.h"
#include "survey/network/outliers.h"

namespace survey {

struct ControlOfNetworkOptions {
  double fixed_sigma_m = 0.002;               // 1 sigma per axis of points that the network holds fixed
  std::size_t max_correlated = 500;           // up to so many points all pairs are given their covariance
  bool degrees = false;                       // angles are degrees in the network's file, else gon
  std::vector<std::string> correlate_always;  // beyond that only pairs of these names
};

// The whole way from the observations of a file: what is wrong with the network is named with its points; approximate
// coordinates, adjustment by the sparse solver, search for outliers (reported, never left out).
struct AdjustedControl {
  bool usable = false;
  std::string message;  // why not usable
  ControlNetwork control;
  std::vector<std::string> warnings;
};
// `leave_out_undetermined`: points that the observations do not determine are left out with a warning.
AdjustedControl AdjustControl(Network network, bool leave_out_undetermined, const ControlOfNetworkOptions& options);

// Points with plane coordinates, in order of their names, as control points; the frame stays empty. Covariances between
// points, summary and observations are filled in. Precondition: adjustment.usable.
ControlNetwork ControlOf(const Network& network, const NetworkAdjustment& adjustment,
                         const std::vector<SuspectedOutlier>& outliers, const ControlOfNetworkOptions& options);

}  // namespace survey
