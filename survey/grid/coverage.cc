// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/coverage.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace survey {
namespace {

void Extend(std::int64_t low, std::int64_t high, std::int64_t* min, std::int64_t* end) {
  *min = std::min(*min, low);
  *end = std::max(*end, high);
}

}  // namespace

Coverage::Coverage(const RasterStrips& map) {
  const SiteRaster& frame = map.frame;
  min_column_ = FloorDivide(frame.min_column, kTileCells);
  min_row_ = FloorDivide(frame.min_row, kTileCells);
  width_ = FloorDivide(frame.min_column + frame.width - 1, kTileCells) - min_column_ + 1;
  height_ = FloorDivide(frame.min_row + frame.height - 1, kTileCells) - min_row_ + 1;
  known_.assign(static_cast<std::size_t>(width_ * height_), 0);
  VisitRows(map, [&](const SiteRaster& rows) { Count(rows); });
}

void Coverage::Count(const SiteRaster& rows) {
  for (int row = 0; row < rows.height; ++row) {
    const std::int64_t tile_row = FloorDivide(rows.min_row + row, kTileCells) - min_row_;
    for (int column = 0; column < rows.width; ++column) {
      if (std::isnan(rows.At(column, row))) continue;
      const std::int64_t tile_column = FloorDivide(rows.min_column + column, kTileCells) - min_column_;
      ++known_[static_cast<std::size_t>(tile_row * width_ + tile_column)];
    }
  }
}

int Coverage::At(std::int64_t tile_column, std::int64_t tile_row) const {
  const std::int64_t column = tile_column - min_column_;
  const std::int64_t row = tile_row - min_row_;
  if (column < 0 || column >= width_ || row < 0 || row >= height_) return 0;
  return known_[static_cast<std::size_t>(row * width_ + column)];
}

CommonCoverage Coverage::With(const Coverage& other) const {
  CommonCoverage common;
  const std::int64_t end_row = std::min(min_row_ + height_, other.min_row_ + other.height_);
  const std::int64_t end_column = std::min(min_column_ + width_, other.min_column_ + other.width_);
  for (std::int64_t row = std::max(min_row_, other.min_row_); row < end_row; ++row) {
    for (std::int64_t column = std::max(min_column_, other.min_column_); column < end_column; ++column) {
      const int cells = std::min(At(column, row), other.At(column, row));
      if (cells == 0) continue;
      const CellBox tile{column * kTileCells, row * kTileCells, (column + 1) * kTileCells, (row + 1) * kTileCells};
      if (common.max_cells == 0) common.box = tile;
      common.max_cells += cells;
      Extend(tile.min_column, tile.end_column, &common.box.min_column, &common.box.end_column);
      Extend(tile.min_row, tile.end_row, &common.box.min_row, &common.box.end_row);
    }
  }
  return common;
}

SiteRaster FrameWithin(const SiteRaster& frame, const CellBox& box, std::int64_t margin) {
  const std::int64_t first_row = std::max(frame.min_row, box.min_row - margin);
  const std::int64_t end_row = std::min(frame.min_row + frame.height, box.end_row + margin);
  const std::int64_t first_column = std::max(frame.min_column, box.min_column - margin);
  const std::int64_t end_column = std::min(frame.min_column + frame.width, box.end_column + margin);
  if (first_row >= end_row || first_column >= end_column) return {.cell_size_m = frame.cell_size_m};
  return {.cell_size_m = frame.cell_size_m,
          .min_column = first_column,
          .min_row = first_row,
          .width = static_cast<int>(end_column - first_column),
          .height = static_cast<int>(end_row - first_row)};
}

SiteRaster PartOf(const RasterStrips& map, const CellBox& box, std::int64_t margin) {
  SiteRaster part = FrameWithin(map.frame, box, margin);
  if (part.width == 0) return part;
  const SiteRaster rows = map.read(part.min_row, part.height);
  for (int row = 0; row < rows.height; ++row) {
    const auto from = rows.log_odds.begin() + static_cast<std::ptrdiff_t>(rows.Index(0, row)) +
                      (part.min_column - map.frame.min_column);
    part.log_odds.insert(part.log_odds.end(), from, from + part.width);
  }
  return part;
}

RasterStrips WithPart(const RasterStrips& map, SiteRaster part) {
  RasterStrips result = map;
  result.read = [read = map.read, part = std::move(part)](std::int64_t min_row, int height) {
    SiteRaster rows = read(min_row, height);
    const auto left = static_cast<int>(part.min_column - rows.min_column);
    const std::int64_t end = std::min(min_row + height, part.min_row + part.height);
    for (std::int64_t row = std::max(min_row, part.min_row); row < end; ++row) {
      const float* from = &part.log_odds[part.Index(0, static_cast<int>(row - part.min_row))];
      std::copy_n(from, part.width, &rows.log_odds[rows.Index(left, static_cast<int>(row - min_row))]);
    }
    return rows;
  };
  return result;
}

}  // namespace survey
