// SPDX-License-Identifier: Apache-2.0
//
// Small pictures of a map for documents: light, thin walls kept; the whole map, or windows of it at its own cells.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace formats {

struct MapThumbnail {
  std::string png;                                       // bytes; rows from the north
  Eigen::Vector2d south_west = Eigen::Vector2d::Zero();  // corner in the site frame, m
  Eigen::Vector2d extent_m = Eigen::Vector2d::Zero();    // east, north
};

// From a delivered map (site.tif: occupancy in percent, 255 unknown), longer side at most `max_pixels`. DataError names
// the file when it is no such map.
MapThumbnail ReadMapThumbnail(const std::filesystem::path& file, int max_pixels);

// Squares about places of the site, cell by cell; what lies outside of the map is unknown.
std::vector<MapThumbnail> ReadMapWindows(const std::filesystem::path& file,
                                         const std::vector<Eigen::Vector2d>& centres_in_site, double half_width_m);

}  // namespace formats
