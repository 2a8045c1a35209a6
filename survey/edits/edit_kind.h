// SPDX-License-Identifier: Apache-2.0
//
// The words of map edits: what they do to a map, and what kind of obstacle a person drew ([AS] section IV-B).
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace survey {

enum class CellState { kOccupied, kFree, kUnknown };

inline constexpr std::array kCellStates = {CellState::kOccupied, CellState::kFree, CellState::kUnknown};

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

enum class EditKind {
  kLineOccupied,
  kLineFree,
  kAreaOccupied,
  kAreaFree,
  kAreaUnknown,
  kCells,        // squares of the raster, with a state
  kForbidden,    // robots keep out; never drawn into the occupancy
  kMaskReturns,  // mirror images, people: the returns from there are dropped before `track`
  kAdjust        // arrows: what the map shows here lies there
};

inline constexpr std::array kEditKinds = {EditKind::kLineOccupied, EditKind::kLineFree,    EditKind::kAreaOccupied,
                                          EditKind::kAreaFree,     EditKind::kAreaUnknown, EditKind::kCells,
                                          EditKind::kForbidden,    EditKind::kMaskReturns, EditKind::kAdjust};

constexpr std::string_view Name(EditKind kind) {
  switch (kind) {
    case EditKind::kLineOccupied:
      return "line_occupied";
    case EditKind::kLineFree:
      return "line_free";
    case EditKind::kAreaOccupied:
      return "area_occupied";
    case EditKind::kAreaFree:
      return "area_free";
    case EditKind::kAreaUnknown:
      return "area_unknown";
    case EditKind::kCells:
      return "cells";
    case EditKind::kForbidden:
      return "forbidden";
    case EditKind::kMaskReturns:
      return "mask_returns";
    case EditKind::kAdjust:
      return "adjust";
  }
  return "";
}

// Rings (an area with holes, or squares) rather than lines.
constexpr bool IsArea(EditKind kind) {
  return kind != EditKind::kLineOccupied && kind != EditKind::kLineFree && kind != EditKind::kAdjust;
}

// What a kind sets cells to; empty for those that leave the occupancy alone, and for cells, which say it themselves.
constexpr std::optional<CellState> StateOf(EditKind kind) {
  switch (kind) {
    case EditKind::kLineOccupied:
    case EditKind::kAreaOccupied:
      return CellState::kOccupied;
    case EditKind::kLineFree:
    case EditKind::kAreaFree:
      return CellState::kFree;
    case EditKind::kAreaUnknown:
      return CellState::kUnknown;
    default:
      return std::nullopt;
  }
}

enum class ObstacleClass {
  kNone,
  kLow,
  kHigh,
  kFurniture,
  kGlass,
  kMirror,
  kDownStairs,
  kHole,
  kRamp,
  kVirtual,
  kTransient,
  kArtefact
};

inline constexpr std::array kObstacleClasses = {
    ObstacleClass::kNone,  ObstacleClass::kLow,     ObstacleClass::kHigh,       ObstacleClass::kFurniture,
    ObstacleClass::kGlass, ObstacleClass::kMirror,  ObstacleClass::kDownStairs, ObstacleClass::kHole,
    ObstacleClass::kRamp,  ObstacleClass::kVirtual, ObstacleClass::kTransient,  ObstacleClass::kArtefact};

constexpr std::string_view Name(ObstacleClass obstacle) {
  switch (obstacle) {
    case ObstacleClass::kNone:
      return "";
    case ObstacleClass::kLow:
      return "low";
    case ObstacleClass::kHigh:
      return "high";
    case ObstacleClass::kFurniture:
      return "furniture";
    case ObstacleClass::kGlass:
      return "glass";
    case ObstacleClass::kMirror:
      return "mirror";
    case ObstacleClass::kDownStairs:
      return "down_stairs";
    case ObstacleClass::kHole:
      return "hole";
    case ObstacleClass::kRamp:
      return "ramp";
    case ObstacleClass::kVirtual:
      return "virtual";
    case ObstacleClass::kTransient:
      return "transient";
    case ObstacleClass::kArtefact:
      return "artefact";
  }
  return "";
}

// [AS] section IV-B: 1 outside the plane of the lidar, 2 transparent or reflecting, 3 not navigable, 4 wished by
// people; 0 none of them (what was there for a while, what was never there).
constexpr int AslamType(ObstacleClass obstacle) {
  switch (obstacle) {
    case ObstacleClass::kLow:
    case ObstacleClass::kHigh:
    case ObstacleClass::kFurniture:
      return 1;
    case ObstacleClass::kGlass:
    case ObstacleClass::kMirror:
      return 2;
    case ObstacleClass::kDownStairs:
    case ObstacleClass::kHole:
    case ObstacleClass::kRamp:
      return 3;
    case ObstacleClass::kVirtual:
      return 4;
    default:
      return 0;
  }
}

// What the person looked at. `map`: the drawn map, so that the edit moves with it; `site`: measured or drawn in site
// coordinates (total station, architect's plan, AR aligned on control), so that it stays.
enum class EditFrame { kMap, kSite };

inline constexpr std::array kEditFrames = {EditFrame::kMap, EditFrame::kSite};

constexpr std::string_view Name(EditFrame frame) { return frame == EditFrame::kMap ? "map" : "site"; }

}  // namespace survey
