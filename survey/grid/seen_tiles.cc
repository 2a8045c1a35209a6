// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/seen_tiles.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

constexpr std::size_t kCellsOfTile = static_cast<std::size_t>(kTileCells) * kTileCells;

std::ptrdiff_t IndexInTile(std::int64_t column, std::int64_t row) {
  return (row - FloorDivide(row, kTileCells) * kTileCells) * kTileCells + column -
         FloorDivide(column, kTileCells) * kTileCells;
}

}  // namespace

SeenTiles::SeenTiles(const RasterStrips& map)
    : frame_(FrameOf(map.frame)),
      min_column_(FloorDivide(map.frame.min_column, kTileCells)),
      min_row_(FloorDivide(map.frame.min_row, kTileCells)),
      width_(FloorDivide(map.frame.min_column + map.frame.width - 1, kTileCells) - min_column_ + 1) {
  const std::int64_t height = FloorDivide(map.frame.min_row + map.frame.height - 1, kTileCells) - min_row_ + 1;
  place_.assign(static_cast<std::size_t>(width_ * height), kNothingSeen);
  VisitRows(map, [&](const SiteRaster& rows) { TakeRows(rows); });
  cells_.shrink_to_fit();
}

std::size_t SeenTiles::TileOf(std::int64_t column, std::int64_t row) const {
  return static_cast<std::size_t>((FloorDivide(row, kTileCells) - min_row_) * width_ + FloorDivide(column, kTileCells) -
                                  min_column_);
}

void SeenTiles::TakeRows(const SiteRaster& rows) {
  for (int r = 0; r < rows.height; ++r) {
    const std::int64_t row = rows.min_row + r;
    for (int c = 0; c < rows.width; ++c) {
      const float value = rows.At(c, r);
      if (std::isnan(value)) continue;
      const std::int64_t column = rows.min_column + c;
      std::int32_t& place = place_[TileOf(column, row)];
      if (place == kNothingSeen) {
        place = static_cast<std::int32_t>(cells_.size() / kCellsOfTile);
        cells_.resize(cells_.size() + kCellsOfTile, kUnknownLogOdds);
      }
      cells_[static_cast<std::size_t>(place) * kCellsOfTile + static_cast<std::size_t>(IndexInTile(column, row))] =
          value;
    }
  }
}

SiteRaster SeenTiles::Part(const CellBox& box, std::int64_t margin) const {
  const std::int64_t first_row = std::max(frame_.min_row, box.min_row - margin);
  const std::int64_t end_row = std::min(frame_.min_row + frame_.height, box.end_row + margin);
  const std::int64_t first_column = std::max(frame_.min_column, box.min_column - margin);
  const std::int64_t end_column = std::min(frame_.min_column + frame_.width, box.end_column + margin);
  SiteRaster part{.cell_size_m = frame_.cell_size_m};
  if (first_row >= end_row || first_column >= end_column) return part;
  part.min_row = first_row;
  part.height = static_cast<int>(end_row - first_row);
  part.min_column = first_column;
  part.width = static_cast<int>(end_column - first_column);
  part.log_odds.assign(part.Index(0, part.height), kUnknownLogOdds);
  for (std::int64_t row = first_row; row < end_row; ++row) CopyRow(row, &part);
  return part;
}

// Tile by tile; what none has seen stays unknown.
void SeenTiles::CopyRow(std::int64_t row, SiteRaster* part) const {
  auto to = part->log_odds.begin() + static_cast<std::ptrdiff_t>(part->Index(0, static_cast<int>(row - part->min_row)));
  const std::int64_t end = part->min_column + part->width;
  for (std::int64_t column = part->min_column; column < end;) {
    const std::int64_t next = std::min(end, (FloorDivide(column, kTileCells) + 1) * kTileCells);
    const std::int32_t place = place_[TileOf(column, row)];
    if (place != kNothingSeen) {
      const auto from = cells_.begin() + static_cast<std::ptrdiff_t>(kCellsOfTile) * place + IndexInTile(column, row);
      std::copy(from, from + (next - column), to);
    }
    to += next - column;
    column = next;
  }
}

}  // namespace survey
