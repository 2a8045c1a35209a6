// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/mosaic.h"

#include <algorithm>

namespace survey {
namespace {

SiteRaster EmptyOver(std::span<const SiteRaster* const> blocks) {
  SiteRaster site;
  if (blocks.empty()) return site;
  site.cell_size_m = blocks.front()->cell_size_m;
  site.min_column = blocks.front()->min_column;
  site.min_row = blocks.front()->min_row;
  std::int64_t end_column = site.min_column;
  std::int64_t end_row = site.min_row;
  for (const SiteRaster* block : blocks) {
    site.min_column = std::min(site.min_column, block->min_column);
    site.min_row = std::min(site.min_row, block->min_row);
    end_column = std::max(end_column, block->min_column + block->width);
    end_row = std::max(end_row, block->min_row + block->height);
  }
  site.width = static_cast<int>(end_column - site.min_column);
  site.height = static_cast<int>(end_row - site.min_row);
  const std::size_t cells = static_cast<std::size_t>(site.width) * static_cast<std::size_t>(site.height);
  site.log_odds.assign(cells, kUnknownLogOdds);
  if (std::none_of(blocks.begin(), blocks.end(), [](const SiteRaster* block) { return block->sigma_m.empty(); }))
    site.sigma_m.assign(cells, std::numeric_limits<float>::quiet_NaN());
  return site;
}

}  // namespace

SiteRaster Mosaic(std::span<const SiteRaster* const> blocks, const MosaicOptions& options) {
  SiteRaster site = EmptyOver(blocks);
  for (const SiteRaster* block : blocks) {
    const int first_column = static_cast<int>(block->min_column - site.min_column);
    const int first_row = static_cast<int>(block->min_row - site.min_row);
    for (int row = 0; row < block->height; ++row) {
      for (int column = 0; column < block->width; ++column) {
        const float value = block->At(column, row);
        if (std::isnan(value)) continue;
        float& sum = site.At(first_column + column, first_row + row);
        sum = std::isnan(sum) ? value : sum + value;
        if (site.sigma_m.empty()) continue;
        float& sigma = site.sigma_m[site.Index(first_column + column, first_row + row)];
        sigma = std::fmax(sigma, block->sigma_m[block->Index(column, row)]);  // NaN only where both are
      }
    }
  }
  for (float& value : site.log_odds) {
    if (!std::isnan(value)) value = std::clamp(value, options.min_log_odds, options.max_log_odds);
  }
  return site;
}

}  // namespace survey
