// SPDX-License-Identifier: Apache-2.0
//
// What stands in a raster of Plumbline, whatever its content: for `show` and `check`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace formats {

struct RasterFacts {
  int width = 0;
  int height = 0;
  double cell_size_m = 0.0;
  double west = 0.0;  // outer edges, site frame, m
  double south = 0.0;
  double east = 0.0;
  double north = 0.0;
  std::string crs;      // name, and authority code where it has one
  std::string content;  // "occupancy log-odds", ...
  std::string tied;     // "yes" or "no"
  std::string data_type;
  int num_overviews = 0;
  // Values that are not "unknown".
  std::int64_t num_known = 0;
  double min = 0.0;
  double max = 0.0;
  double mean = 0.0;
  // Of the second band, where there is one: positional uncertainty, m.
  struct Sigma {
    double min = 0.0;
    double mean = 0.0;
    double max = 0.0;
  };
  std::optional<Sigma> sigma_m;
};

// Reads every cell. DataError when the file is not a raster of Plumbline or cannot be read to its end.
RasterFacts ReadRasterFacts(const std::filesystem::path& file);

}  // namespace formats
