// SPDX-License-Identifier: Apache-2.0
//
// Standard deviations on the data lines of a STAR*NET file: a number (arc seconds for angles), ! fixed, * free, & or
// nothing for the default that the project keeps outside the file.
#pragma once

#include <optional>

#include "formats/network_file.h"
#include "formats/starnet_settings.h"
#include "survey/network/network.h"

namespace formats {

// Reads the next standard deviation of a line, for an observation of this kind and value; empty: the observation is
// free and takes no part. DataError when it is neither written nor a default told.
std::optional<double> ReadStarnetSigma(const survey::Observation& observation, const StarnetSigmas& defaults,
                                       const StarnetSettings& settings, StarnetLine* line);

// Of a levelled line, by its length.
std::optional<double> ReadStarnetLevelSigma(double length_km, const StarnetSigmas& defaults,
                                            const StarnetSettings& settings, StarnetLine* line);

}  // namespace formats
