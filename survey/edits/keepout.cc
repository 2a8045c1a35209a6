// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/keepout.h"

#include <utility>

namespace survey {

RasterStrips KeepoutStrips(const SiteRaster& frame, std::vector<MapEdit> forbidden) {
  const auto read = [frame, forbidden = std::move(forbidden)](std::int64_t min_row, int height) {
    SiteRaster rows = RowsOf(frame, min_row, height);
    rows.log_odds.assign(static_cast<std::size_t>(rows.width) * static_cast<std::size_t>(rows.height), -kEditedLogOdds);
    for (const MapEdit& area : forbidden)
      ForEachCell(area, rows, [&](int column, int row) { rows.At(column, row) = kEditedLogOdds; });
    return rows;
  };
  return {frame, false, read};
}

}  // namespace survey
