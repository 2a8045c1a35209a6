// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/drawn_by.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "survey/grid/line_cells.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

// Scans so far apart along the path are of one stretch.
constexpr int kStretch = 20;
// Rays of a scan that are followed; cells between them are found beside.
constexpr std::size_t kRays = 400;
constexpr double kRangeStep_m = 0.25;

// The majority so far, packed: a map has millions of cells.
struct Vote {
  std::uint16_t witness = 0;  // index into the asked scans
  std::uint8_t count = 0;
  std::uint8_t range = 0;  // in kRangeStep_m
};

void Cast(std::uint16_t witness, std::uint8_t range, Vote* vote) {
  if (vote->count == 0) {
    *vote = {witness, 1, range};
  } else if (std::abs(witness - vote->witness) > kStretch) {
    --vote->count;
  } else {
    if (vote->count < 255) ++vote->count;
    if (range <= vote->range) *vote = {witness, vote->count, range};
  }
}

std::vector<std::size_t> AskedScans(const std::vector<Pose2>& poses, const WitnessOptions& options) {
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < poses.size() && asked.size() < std::numeric_limits<std::uint16_t>::max(); ++i) {
    if (!asked.empty()) {
      const Pose2 motion = Between(poses[asked.back()], poses[i]);
      if (motion.Translation().norm() < options.spacing_m && std::abs(motion.theta) < options.turn_rad) continue;
    }
    asked.push_back(i);
  }
  return asked;
}

// Whether the segment's bounding box meets the raster; in cells from its corner.
bool Meets(const SiteRaster& raster, const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  const Eigen::Array2f low = a.cwiseMin(b);
  const Eigen::Array2f high = a.cwiseMax(b);
  return (high >= 0.0F).all() && low.x() < static_cast<float>(raster.width) &&
         low.y() < static_cast<float>(raster.height);
}

class Votes {
 public:
  explicit Votes(const SiteRaster& raster) : raster_(raster), votes_(raster.log_odds.size()) {}

  // `points` are end points in cells from the raster's corner, `origin` the lidar.
  void Add(std::uint16_t witness, const Eigen::Vector2f& origin, const std::vector<Eigen::Vector2f>& points) {
    const std::size_t step = std::max<std::size_t>(1, points.size() / kRays);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2f& end = points[i];
      At(witness, origin, static_cast<int>(std::floor(end.x())), static_cast<int>(std::floor(end.y())), true);
      if (i % step != 0 || !Meets(raster_, origin, end)) continue;
      ForEachCellOnLine(origin, end, [&](int column, int row) { At(witness, origin, column, row, false); });
    }
  }

  const Vote& of(std::size_t cell) const { return votes_[cell]; }

 private:
  void At(std::uint16_t witness, const Eigen::Vector2f& origin, int column, int row, bool hit) {
    if (!raster_.Contains(column, row)) return;
    const std::size_t cell = raster_.Index(column, row);
    if (hit != (raster_.log_odds[cell] > 0.0F)) return;  // it does not show what the scan saw
    const Eigen::Vector2f centre(static_cast<float>(column) + 0.5F, static_cast<float>(row) + 0.5F);
    const double range_m = static_cast<double>((centre - origin).norm()) * raster_.cell_size_m;
    Cast(witness, static_cast<std::uint8_t>(std::min(255.0, range_m / kRangeStep_m)), &votes_[cell]);
  }

  const SiteRaster& raster_;
  std::vector<Vote> votes_;
};

}  // namespace

void FillDrawnBy(const Session& session, const std::vector<Pose2>& site_from_scan, const WitnessOptions& options,
                 SiteRaster* raster) {
  const std::vector<std::size_t> asked = AskedScans(site_from_scan, options);
  const ScanProjector projector(session.geometries, options.max_range_m, 0.0);
  const double cell = raster->cell_size_m;
  const Eigen::Vector2d corner(static_cast<double>(raster->min_column) * cell,
                               static_cast<double>(raster->min_row) * cell);
  Votes votes(*raster);
  ScanPoints points;
  std::vector<Eigen::Vector2f> ends;
  const auto pose_of = [&](std::size_t i) { return site_from_scan[i]; };
  const Eigen::Vector2f reach = Eigen::Vector2f::Constant(static_cast<float>(options.max_range_m / cell));
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const Eigen::Vector2f origin = ((site_from_scan[asked[k]].Translation() - corner) / cell).cast<float>();
    if (!Meets(*raster, origin - reach, origin + reach)) continue;
    projector.Project(session, asked[k], TwistOfScan(session.scans, pose_of, asked[k]), &points);
    Pose2 pose = site_from_scan[asked[k]];
    pose.x -= corner.x();
    pose.y -= corner.y();
    TransformPoints(pose, points.hits, &ends);
    for (Eigen::Vector2f& end : ends) end /= static_cast<float>(cell);
    votes.Add(static_cast<std::uint16_t>(k), origin, ends);
  }
  raster->drawn_by.assign(raster->log_odds.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < raster->drawn_by.size(); ++i) {
    if (votes.of(i).count > 0) raster->drawn_by[i] = static_cast<float>(asked[votes.of(i).witness]);
  }
}

}  // namespace survey
