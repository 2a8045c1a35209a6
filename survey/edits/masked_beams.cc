// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/masked_beams.h"

#include <algorithm>
#include <cmath>

namespace survey {
namespace {

bool HasReturn(float range_m) { return std::isfinite(range_m); }

// Appends the runs of one scan.
void AddRuns(const MapEdit& area, StampNs stamp_ns, std::span<const float> ranges_m, const ScanGeometry& geometry,
             const Pose2& site_from_scan, std::vector<MaskedBeams>* runs) {
  const std::size_t before = runs->size();
  for (int beam = 0; beam < geometry.num_beams; ++beam) {
    const float range_m = ranges_m[static_cast<std::size_t>(beam)];
    if (!HasReturn(range_m)) continue;
    const double angle = geometry.angle_min_rad + beam * geometry.angle_increment_rad;
    const Eigen::Vector2d end = site_from_scan * Eigen::Vector2d(static_cast<double>(range_m) * std::cos(angle),
                                                                 static_cast<double>(range_m) * std::sin(angle));
    if (!IsInside(area, end)) continue;
    const bool goes_on = runs->size() > before && runs->back().last == beam - 1;
    if (goes_on) {
      runs->back().last = beam;
    } else {
      runs->push_back({stamp_ns, beam, beam});
    }
  }
}

bool IsInTime(const MapEdit& area, StampNs stamp_ns) {
  return stamp_ns >= area.from_ns.value_or(stamp_ns) && stamp_ns <= area.until_ns.value_or(stamp_ns);
}

}  // namespace

std::vector<MaskedBeams> BeamsInside(const MapEdit& area, const Session& session,
                                     const std::vector<Pose2>& site_from_scan) {
  std::vector<MaskedBeams> runs;
  std::vector<float> buffer;
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    const Scan& scan = session.scans[i];
    if (!IsInTime(area, scan.stamp_ns)) continue;
    AddRuns(area, scan.stamp_ns, RangesOf(session, i, &buffer),
            session.geometries[static_cast<std::size_t>(scan.geometry)], site_from_scan[i], &runs);
  }
  return runs;
}

std::size_t DropBeams(std::span<const MaskedBeams> beams, Session* session) {
  std::size_t dropped = 0;
  for (const MaskedBeams& run : beams) {
    const auto scan = std::lower_bound(session->scans.begin(), session->scans.end(), run.stamp_ns,
                                       [](const Scan& each, StampNs stamp_ns) { return each.stamp_ns < stamp_ns; });
    if (scan == session->scans.end() || scan->stamp_ns != run.stamp_ns) continue;
    const int last = std::min(run.last, static_cast<int>(scan->ranges_m.size()) - 1);
    for (int beam = std::max(0, run.first); beam <= last; ++beam) {
      float& range_m = scan->ranges_m[static_cast<std::size_t>(beam)];
      if (HasReturn(range_m)) ++dropped;
      range_m = kInvalidRange;
    }
  }
  return dropped;
}

}  // namespace survey
