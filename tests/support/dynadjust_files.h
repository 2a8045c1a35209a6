// SPDX-License-Identifier: Apache-2.0
//
// DynAdjust's sample network (DNA 3.01 station and measurement files) with its expected adjustment. The geoid model
// that DynAdjust used is not at hand; what it corrected with it stands beside each measurement of the expected output:
// deflections of the vertical are taken from there, heights from the surface through what is printed
// (dynadjust_geoid.h), so that their rounding to 0.1 mm does not matter.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/network/network.h"

namespace test_support {

struct ExpectedMeasurement {
  char type = 0;
  std::vector<std::string> stations;
  std::string component;  // X, Y, Z or P, L, H of a cluster
  double measured = 0.0;  // m, or arc seconds
  double adjusted = 0.0;
  double correction = 0.0;
  double sigma_adjusted = 0.0;
  double sigma_correction = 0.0;
  double n_statistic = 0.0;
  double before = 0.0;  // correction before the adjustment: geoid, deflection of the vertical
};

struct DynAdjustNetwork {
  survey::Network network;                          // geocentric
  std::vector<ExpectedMeasurement> expected;        // of network.observations, in their order, then the constraints
  std::vector<Eigen::Vector3d> expected_positions;  // of network.points
  std::vector<Eigen::Vector3d> expected_sigmas;     // east, north, up
  double geoid_misfit = 0.0;      // largest, of what is printed of the geoid against the surface through it (m)
  int num_loose_constraints = 0;  // of 10 m, which complete the triples of partly constrained stations
  double chi_square = 0.0;
  int degrees_of_freedom = 0;
};

DynAdjustNetwork ReadDynAdjust(const std::filesystem::path& folder);

}  // namespace test_support
