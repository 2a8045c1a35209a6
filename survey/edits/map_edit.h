// SPDX-License-Identifier: Apache-2.0
//
// A person's correction of a map ([AS] section IV: cells may be set to free, occupied or unknown).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "survey/grid/site_raster.h"

namespace survey {

enum class CellState { kOccupied, kFree, kUnknown };

constexpr std::string_view Name(CellState state) {
  switch (state) {
    case CellState::kOccupied:
      return "occupied";
    case CellState::kFree:
      return "free";
    case CellState::kUnknown:
      return "unknown";
  }
  return "";
}

// Site coordinates (x east, y north, m). A line is as wide as width_m, without gaps; an area is an outer ring and
// holes, each closed by itself.
struct MapEdit {
  CellState state = CellState::kUnknown;
  bool is_area = false;
  std::vector<std::vector<Eigen::Vector2d>> parts;  // one line, or the rings
  std::optional<double> width_m;                    // lines only; empty: as thin as the cells allow
  std::string who;
  std::string why;
};

// Log-odds that an edit gives to a cell; beyond what observations reach, so that an edit outweighs them.
inline constexpr float kEditedLogOdds = 6.0F;

// Sets the cells whose centre lies in the area or within half the width of the line. Returns how many cells changed.
std::int64_t ApplyEdit(const MapEdit& edit, SiteRaster* raster);

// First pair of edges of an area that cross each other or a vertex that lies on another edge's inside; empty when the
// rings are simple and apart.
std::optional<Eigen::Vector2d> FindSelfCrossing(const MapEdit& edit);

// Distance from the raster's rectangle to the nearest corner of the edit, 0 when one lies inside or the edit's bounding
// box meets the rectangle (m).
double DistanceToRaster(const MapEdit& edit, const SiteRaster& raster);

}  // namespace survey
