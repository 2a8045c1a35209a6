// SPDX-License-Identifier: Apache-2.0
//
// A person's correction of a map ([AS] section IV).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "survey/edits/edit_kind.h"
#include "survey/grid/coverage.h"
#include "survey/grid/site_raster.h"
#include "survey/sensors/session.h"

namespace survey {

// A vertex as the scan saw it that drew the map there: it moves with that scan.
struct EditAnchor {
  StampNs stamp_ns = 0;  // of the scan, on its block's clock
  Eigen::Vector2d p_in_scan = Eigen::Vector2d::Zero();

  bool operator==(const EditAnchor&) const = default;
};

// Beams first ... last of a scan.
struct MaskedBeams {
  StampNs stamp_ns = 0;
  int first = 0;
  int last = 0;

  bool operator==(const MaskedBeams&) const = default;
};

// A correction as the ledger has it. Site coordinates (x east, y north, m) of the map on which it was drawn.
struct MapEdit {
  std::string uid;
  int revision = 1;
  EditKind kind = EditKind::kAreaUnknown;
  std::optional<CellState> cells_state;             // of kCells
  std::vector<std::vector<Eigen::Vector2d>> parts;  // lines, or rings that close themselves; arrows: from, to
  std::optional<double> width_m;                    // of lines; empty: as thin as the cells allow
  ObstacleClass obstacle = ObstacleClass::kNone;
  EditFrame frame = EditFrame::kMap;
  double sigma_m = 0.05;             // of a vertex, per axis
  std::optional<StampNs> from_ns;    // of kMaskReturns: returns of scans from ...
  std::optional<StampNs> until_ns;   // ... to this stamp, both included; empty: of all earlier, later ones
  std::string who, when, why, tool;  // when: 2026-11-28T10:15:00Z
  std::vector<std::string> supersedes;

  // By block. Anchors: one per vertex in the order of `parts`, empty where no scan of the block saw the place.
  std::map<std::string, std::string> basis;  // id of the record of the solution it was drawn on
  std::map<std::string, std::vector<std::optional<EditAnchor>>> anchors;
  std::map<std::string, std::vector<MaskedBeams>> beams;  // of kMaskReturns

  bool operator==(const MapEdit&) const = default;
};

// What the edit sets cells to; empty when it leaves the occupancy alone.
inline std::optional<CellState> StateOf(const MapEdit& edit) {
  return edit.kind == EditKind::kCells ? edit.cells_state : StateOf(edit.kind);
}

std::size_t NumVertices(const MapEdit& edit);

// Log-odds that an edit gives to a cell; beyond what observations reach, so that an edit outweighs them.
inline constexpr float kEditedLogOdds = 6.0F;

// Whether an area holds the point: even-odd rule over all rings, so that holes count.
bool IsInside(const MapEdit& edit, const Eigen::Vector2d& p);

using CellVisitor = std::function<void(int column, int row)>;

// The cells of the raster whose centre lies in the area or within half the width of the line.
void ForEachCell(const MapEdit& edit, const SiteRaster& raster, const CellVisitor& visit);

// Sets these cells. Returns how many changed; 0 for edits that leave the occupancy alone.
std::int64_t ApplyEdit(const MapEdit& edit, SiteRaster* raster);

// First pair of edges of an area that cross each other or a vertex that lies on another edge's inside; empty when the
// rings are simple and apart.
std::optional<Eigen::Vector2d> FindSelfCrossing(const MapEdit& edit);

// The site cells that an edit may reach.
CellBox BoxOf(const MapEdit& edit, double cell_size_m);

// Distance from the raster's rectangle to the edit's bounding box, 0 when they meet (m).
double DistanceToRaster(const MapEdit& edit, const SiteRaster& raster);
double DistanceToRaster(const Eigen::Vector2d& p, const SiteRaster& raster);

}  // namespace survey
