// SPDX-License-Identifier: Apache-2.0
#include "formats/map_codes.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace formats {

std::uint8_t PercentOf(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownCode;
  return static_cast<std::uint8_t>(std::lround(100.0 * survey::ProbabilityFromLogOdds(log_odds)));
}

std::uint8_t SigmaStepsOf(float sigma_m) {
  if (std::isnan(sigma_m)) return kUnknownCode;
  return static_cast<std::uint8_t>(std::lround(std::min(254.0, static_cast<double>(sigma_m) / kSigmaStep_m)));
}

std::vector<std::uint8_t> CodesFromNorth(const survey::SiteRaster& rows, Layer layer, CellCode code) {
  std::vector<std::uint8_t> codes((rows.*layer).size());
  std::uint8_t* to = codes.data();
  // Most cells hold what their neighbour holds: nothing, or the least or most that a cell can.
  auto last = std::bit_cast<std::uint32_t>(survey::kUnknownLogOdds);
  std::uint8_t last_code = code(survey::kUnknownLogOdds);
  for (int row = rows.height - 1; row >= 0; --row) {
    const float* from = (rows.*layer).data() + rows.Index(0, row);
    for (int column = 0; column < rows.width; ++column) {
      const auto bits = std::bit_cast<std::uint32_t>(from[column]);
      if (bits != last) {
        last = bits;
        last_code = code(from[column]);
      }
      *to++ = last_code;
    }
  }
  return codes;
}

std::vector<std::uint8_t> Halved(const std::vector<std::uint8_t>& fine, int width, std::uint8_t unknown) {
  const int height = static_cast<int>(fine.size()) / width;
  const int coarse_width = (width + 1) / 2;
  std::vector<std::uint8_t> coarse(static_cast<std::size_t>(coarse_width) * static_cast<std::size_t>((height + 1) / 2),
                                   unknown);
  for (int row = 0; row < height; ++row) {
    const std::uint8_t* from = fine.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    std::uint8_t* to = coarse.data() + static_cast<std::size_t>(row / 2) * static_cast<std::size_t>(coarse_width);
    for (int column = 0; column < width; ++column) {
      std::uint8_t& cell = to[column / 2];
      if (from[column] != unknown && (cell == unknown || from[column] > cell)) cell = from[column];
    }
  }
  return coarse;
}

}  // namespace formats
