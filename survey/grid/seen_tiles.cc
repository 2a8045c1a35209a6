// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/seen_tiles.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr std::size_t kCellsOfTile = static_cast<std::size_t>(kTileCells) * kTileCells;

std::int64_t EndOfTile(std::int64_t cell) { return (FloorDivide(cell, kTileCells) + 1) * kTileCells; }

std::size_t IndexInTile(std::int64_t column, std::int64_t row) {
  return static_cast<std::size_t>((row - FloorDivide(row, kTileCells) * kTileCells) * kTileCells + column -
                                  FloorDivide(column, kTileCells) * kTileCells);
}

}  // namespace

TiledLayer::TiledLayer(const SiteRaster& frame, float nothing)
    : nothing_(nothing),
      min_column_(FloorDivide(frame.min_column, kTileCells)),
      min_row_(FloorDivide(frame.min_row, kTileCells)),
      width_(FloorDivide(frame.min_column + frame.width - 1, kTileCells) - min_column_ + 1) {
  const std::int64_t height = FloorDivide(frame.min_row + frame.height - 1, kTileCells) - min_row_ + 1;
  place_.assign(static_cast<std::size_t>(width_ * height), kNotKept);
}

bool TiledLayer::IsNothing(float value) const {
  return value == nothing_ || (std::isnan(nothing_) && std::isnan(value));
}

std::size_t TiledLayer::TileOf(std::int64_t column, std::int64_t row) const {
  return static_cast<std::size_t>((FloorDivide(row, kTileCells) - min_row_) * width_ + FloorDivide(column, kTileCells) -
                                  min_column_);
}

void TiledLayer::Take(const CellBox& box, const SiteRaster& raster, const std::vector<float>& cells) {
  for (std::int64_t row = box.min_row; row < box.end_row; ++row) {
    const float* from = cells.data() + raster.Index(0, static_cast<int>(row - raster.min_row));
    for (std::int64_t column = box.min_column; column < box.end_column;) {
      const std::int64_t end = std::min(box.end_column, EndOfTile(column));
      TakeRun(column, row, from + (column - raster.min_column), end - column);
      column = end;
    }
  }
}

void TiledLayer::TakeRun(std::int64_t column, std::int64_t row, const float* from, std::int64_t count) {
  if (std::all_of(from, from + count, [this](float value) { return IsNothing(value); })) return;
  std::int32_t& place = place_[TileOf(column, row)];
  if (place == kNotKept) {
    place = static_cast<std::int32_t>(cells_.size() / kCellsOfTile);
    cells_.resize(cells_.size() + kCellsOfTile, nothing_);
  }
  std::copy_n(from, count, &cells_[static_cast<std::size_t>(place) * kCellsOfTile + IndexInTile(column, row)]);
}

std::vector<float> TiledLayer::Cells(const SiteRaster& part) const {
  std::vector<float> cells(part.Index(0, part.height), nothing_);
  for (int r = 0; r < part.height; ++r) {
    const std::int64_t row = part.min_row + r;
    float* to = cells.data() + part.Index(0, r);
    for (std::int64_t column = part.min_column; column < part.min_column + part.width;) {
      const std::int64_t end = std::min(part.min_column + part.width, EndOfTile(column));
      const std::int32_t place = place_[TileOf(column, row)];
      if (place != kNotKept)
        std::copy_n(&cells_[static_cast<std::size_t>(place) * kCellsOfTile + IndexInTile(column, row)], end - column,
                    to + (column - part.min_column));
      column = end;
    }
  }
  return cells;
}

bool TiledLayer::AnyIn(const CellBox& box) const {
  for (std::int64_t row = box.min_row; row < box.end_row; row = EndOfTile(row)) {
    for (std::int64_t column = box.min_column; column < box.end_column; column = EndOfTile(column)) {
      if (place_[TileOf(column, row)] != kNotKept) return true;
    }
  }
  return false;
}

SeenTiles::SeenTiles(const RasterStrips& map) : frame_(FrameOf(map.frame)), log_odds_(map.frame, kUnknownLogOdds) {
  VisitRows(map, [&](const SiteRaster& rows) { log_odds_.Take(BoxOf(rows), rows, rows.log_odds); });
}

SiteRaster SeenTiles::Part(const CellBox& box, std::int64_t margin) const {
  SiteRaster part = FrameWithin(frame_, box, margin);
  if (part.width > 0) part.log_odds = log_odds_.Cells(part);
  return part;
}

FacedTiles::FacedTiles(const RasterStrips& map, const SeamOptions& options)
    : map_(map), face_x_(map.frame, 0.0F), face_y_(map.frame, 0.0F) {
  constexpr std::int64_t kSide = 8 * kTileCells;  // what is looked at stays in the processor's cache
  const CellBox whole = BoxOf(map.frame);
  for (std::int64_t row = whole.min_row; row < whole.end_row; row += kSide) {
    for (std::int64_t column = whole.min_column; column < whole.end_column; column += kSide) {
      FindFaces({column, row, std::min(column + kSide, whole.end_column), std::min(row + kSide, whole.end_row)},
                options);
    }
  }
}

void FacedTiles::FindFaces(const CellBox& box, const SeamOptions& options) {
  if (!map_.SawAnythingIn(box)) return;
  const FacedRaster part = WithFaces(map_.Part(box, kFaceReachCells), options);
  face_x_.Take(box, part.map, part.face_x);
  face_y_.Take(box, part.map, part.face_y);
}

FacedRaster FacedTiles::Part(const CellBox& box, std::int64_t margin) const {
  FacedRaster part{.map = map_.Part(box, margin), .face_x = {}, .face_y = {}};
  if (part.map.width == 0) return part;
  part.face_x = face_x_.Cells(part.map);
  part.face_y = face_y_.Cells(part.map);
  return part;
}

}  // namespace survey
