// SPDX-License-Identifier: Apache-2.0
//
// The bytes of maps for people: occupancy in percent, positional uncertainty in steps, and what stands for four cells
// in an overview.
#pragma once

#include <cstdint>
#include <vector>

#include "survey/grid/site_raster.h"

namespace formats {

inline constexpr std::uint8_t kUnknownCode = 255;
inline constexpr double kSigmaStep_m = 0.002;  // 254: 0.508 m or more

using CellCode = std::uint8_t (*)(float value);

std::uint8_t PercentOf(float log_odds);
std::uint8_t SigmaStepsOf(float sigma_m);

// A layer of a raster (its log-odds, its sigmas).
using Layer = std::vector<float> survey::SiteRaster::*;

// The codes of a layer, row by row from the north.
std::vector<std::uint8_t> CodesFromNorth(const survey::SiteRaster& rows, Layer layer, CellCode code);

// Rows of half the width and height: the largest of four codes that is not `unknown`, so that thin walls stay.
std::vector<std::uint8_t> Halved(const std::vector<std::uint8_t>& fine, int width, std::uint8_t unknown);

}  // namespace formats
