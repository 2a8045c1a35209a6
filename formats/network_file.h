// SPDX-License-Identifier: Apache-2.0
//
// Files of survey observations that `network` adjusts: GNU Gama (.gkf) and STAR*NET (.dat). README.md says how each is
// read. All of them end in the site's axes (x east, y north), clockwise radians and metres.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/network/network.h"

namespace formats {

enum class AngleUnit { kGon, kDegrees };

struct NetworkFile {
  survey::Network network;
  AngleUnit angle_unit = AngleUnit::kGon;  // of the file, for reports
  std::vector<std::string> warnings;
};

// Standard deviations that a STAR*NET project keeps outside its data files; 0: not told.
struct StarnetSigmas {
  double distance_m = 0.0;
  double distance_ppm = 0.0;
  double angle_arcsec = 0.0;  // also of directions
  double azimuth_arcsec = 0.0;
  double zenith_arcsec = 0.0;
  double levelling_m_per_sqrt_km = 0.0;  // of height differences
};

// DataError names file, line, value and rule.
NetworkFile ReadGkf(const std::filesystem::path& file);
NetworkFile ReadStarnet(const std::filesystem::path& file, const StarnetSigmas& sigmas);

}  // namespace formats
