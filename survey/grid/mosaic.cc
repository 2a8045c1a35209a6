// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/mosaic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace survey {
namespace {

SiteRaster CommonFrame(const std::vector<RasterStrips>& blocks) {
  if (blocks.empty()) return {};
  SiteRaster site = blocks.front().frame;
  std::int64_t end_column = site.min_column;
  std::int64_t end_row = site.min_row;
  for (const RasterStrips& block : blocks) {
    site.min_column = std::min(site.min_column, block.frame.min_column);
    site.min_row = std::min(site.min_row, block.frame.min_row);
    end_column = std::max(end_column, block.frame.min_column + block.frame.width);
    end_row = std::max(end_row, block.frame.min_row + block.frame.height);
  }
  site.width = static_cast<int>(end_column - site.min_column);
  site.height = static_cast<int>(end_row - site.min_row);
  return site;
}

// Without branches, for the compiler's vector instructions: most of a site is looked at by no block or by one.
void AddLogOdds(const float* part, int count, float* sum) {
  for (int i = 0; i < count; ++i) {
    const float both = sum[i] + part[i];
    const float one = std::isnan(sum[i]) ? part[i] : sum[i];
    sum[i] = std::isnan(both) ? one : both;
  }
}

// Unknown only where both are.
void TakeLarger(const float* part, int count, float* largest) {
  for (int i = 0; i < count; ++i) {
    const float larger = part[i] > largest[i] ? part[i] : largest[i];
    largest[i] = std::isnan(largest[i]) ? part[i] : larger;
  }
}

void Add(const SiteRaster& part, SiteRaster* site) {
  const int first_column = static_cast<int>(part.min_column - site->min_column);
  const int first_row = static_cast<int>(part.min_row - site->min_row);
  for (int row = 0; row < part.height; ++row) {
    const std::size_t from = part.Index(0, row);
    const std::size_t to = site->Index(first_column, first_row + row);
    AddLogOdds(&part.log_odds[from], part.width, &site->log_odds[to]);
    if (!site->sigma_m.empty()) TakeLarger(&part.sigma_m[from], part.width, &site->sigma_m[to]);
  }
}

// The rows of `block` that lie in those of `site` are added.
void AddRows(const RasterStrips& block, SiteRaster* site) {
  const std::int64_t first = std::max(site->min_row, block.frame.min_row);
  const std::int64_t end = std::min(site->min_row + site->height, block.frame.min_row + block.frame.height);
  if (first < end) Add(block.read(first, static_cast<int>(end - first)), site);
}

}  // namespace

RasterStrips MosaicOf(std::vector<RasterStrips> blocks, const MosaicOptions& options) {
  const SiteRaster frame = CommonFrame(blocks);
  const bool has_sigma = !blocks.empty() && std::all_of(blocks.begin(), blocks.end(),
                                                        [](const RasterStrips& block) { return block.has_sigma; });
  const auto read = [frame, has_sigma, blocks = std::move(blocks), options](std::int64_t min_row, int height) {
    SiteRaster rows = RowsOf(frame, min_row, height);
    const std::size_t cells = static_cast<std::size_t>(rows.width) * static_cast<std::size_t>(height);
    rows.log_odds.assign(cells, kUnknownLogOdds);
    if (has_sigma) rows.sigma_m.assign(cells, std::numeric_limits<float>::quiet_NaN());
    for (const RasterStrips& block : blocks) AddRows(block, &rows);
    // A comparison with the unknown is false: it stays.
    for (float& value : rows.log_odds) {
      value = value < options.min_log_odds ? options.min_log_odds : value;
      value = value > options.max_log_odds ? options.max_log_odds : value;
    }
    return rows;
  };
  return {frame, has_sigma, read};
}

SiteRaster Mosaic(std::span<const SiteRaster* const> blocks, const MosaicOptions& options) {
  std::vector<RasterStrips> strips;
  for (const SiteRaster* block : blocks) strips.push_back(StripsOf(*block));
  const RasterStrips mosaic = MosaicOf(std::move(strips), options);
  return mosaic.read(mosaic.frame.min_row, mosaic.frame.height);
}

}  // namespace survey
