// SPDX-License-Identifier: Apache-2.0
#include "pipeline/ros_replies.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/artefacts.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "formats/raster_file.h"
#include "pipeline/site_layout.h"
#include "survey/grid/mosaic.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;

// The block of which a scan has the stamp.
std::string BlockOf(const fs::path& site, survey::StampNs stamp_ns, const std::string& where) {
  std::string found;
  for (const std::string& block : BlocksOf(site)) {
    const fs::path track = site / "work" / block / "track.sqlite";
    if (!fs::exists(track)) continue;
    const std::vector<survey::StampNs> stamps = survey::ClockStamps(formats::ReadScanStamps(track));
    if (!std::binary_search(stamps.begin(), stamps.end(), stamp_ns)) continue;
    if (!found.empty())
      throw DataError(where + ": stamp " + std::to_string(stamp_ns) + " ns: blocks " + found + " and " + block +
                      " both have a scan then");
    found = block;
  }
  if (found.empty()) throw DataError(where + ": stamp " + std::to_string(stamp_ns) + " ns: no block has a scan then");
  return found;
}

nlohmann::json AnswerOf(const formats::RosPose& pose, const std::string& who) {
  const survey::Pose2& site = pose.site_from_robot;
  return {{"schema", 1},
          {"stamp_ns", std::to_string(pose.stamp_ns)},
          {"decision", "correct"},
          {"frame", "site"},
          {"pose", {site.x, site.y, site.theta}},
          {"sigma", {pose.sigma.x(), pose.sigma.y(), pose.sigma.z()}},
          {"operator", who},
          {"tool", "rosbridge"}};
}

}  // namespace

std::vector<survey::MapEdit> EditsOfRosGrid(const fs::path& site, const formats::RosGrid& grid,
                                            const std::string& where) {
  std::vector<survey::RasterStrips> tied;
  std::vector<survey::RasterStrips> local;
  for (const std::string& block : BlocksOf(site)) {
    const fs::path file = site / "work" / block / "map.tif";
    if (!fs::exists(file)) continue;
    formats::RasterLabel label;
    survey::RasterStrips map = formats::OpenRaster(file, &label);
    (label.tied ? tied : local).push_back(std::move(map));
  }
  if (tied.empty() && local.size() == 1) tied = std::move(local);
  if (tied.empty()) throw DataError(site.string() + ": there is no map yet to be edited; plumbline run first");
  return formats::CellEdits(grid, survey::MosaicOf(std::move(tied), {}), where);
}

void RecordPoses(const fs::path& site, const std::vector<formats::RosPose>& poses, const std::string& who,
                 const std::string& where) {
  std::vector<fs::path> files;
  for (const formats::RosPose& pose : poses) {
    const std::string stamp = std::to_string(pose.stamp_ns);
    files.push_back(site / "blocks" / BlockOf(site, pose.stamp_ns, where) / "answers" /
                    ("rosbridge-" + stamp + ".json"));
    if (fs::exists(files.back())) throw DataError(files.back().string() + ": this scan was answered before");
    if (!(pose.sigma.minCoeff() > 0.0)) throw DataError(where + ": stamp " + stamp + " ns: sigmas must be positive");
  }
  for (std::size_t i = 0; i < poses.size(); ++i) formats::WriteJson(files[i], AnswerOf(poses[i], who));
}

}  // namespace pipeline
