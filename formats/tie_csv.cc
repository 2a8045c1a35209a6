// SPDX-License-Identifier: Apache-2.0
#include "formats/tie_csv.h"

#include <set>

#include "formats/csv.h"

namespace formats {

std::vector<survey::TiePoint> ReadTieCsv(const std::filesystem::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"point", "x", "y", "easting", "northing"});
  std::vector<survey::TiePoint> points;
  std::set<std::string> names;
  while (csv.NextRow()) {
    points.push_back({.name = std::string(csv.Text(0)),
                      .in_grid = {csv.Number(1), csv.Number(2)},
                      .in_projected = {csv.Number(3), csv.Number(4)}});
    if (!names.insert(points.back().name).second) csv.Fail(0, "is there twice");
  }
  return points;
}

}  // namespace formats
