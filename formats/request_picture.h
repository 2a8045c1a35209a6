// SPDX-License-Identifier: Apache-2.0
//
// The picture of a review request, north up. About a scan: the map around it, the scan where it was put, where else it
// might lie, the way and the reference scan; 12 m wide. About an edit: the map, the edit where it lies now and as it
// was drawn; 12 m wide or as wide as it needs.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "survey/edits/block_edits.h"
#include "survey/geometry/pose2.h"
#include "survey/grid/raster_strips.h"

namespace formats {

struct RequestPicture {
  survey::Pose2 estimate;               // site_from_scan
  std::vector<survey::Pose2> modes;     // the same
  std::vector<Eigen::Vector2f> points;  // in the frame of the scan
  std::vector<Eigen::Vector2d> way;     // of the stretch, site frame
  std::optional<survey::Pose2> reference;
};

// `map`: log-odds on the site's cells.
void WriteRequestPicture(const std::filesystem::path& file, const survey::RasterStrips& map,
                         const RequestPicture& picture);

void WriteEditPicture(const std::filesystem::path& file, const survey::RasterStrips& map,
                      const survey::AppliedEdit& edit);

}  // namespace formats
