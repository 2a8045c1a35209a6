// SPDX-License-Identifier: Apache-2.0
#include "survey/sensors/session.h"

namespace survey {

std::span<const float> RangesOf(const Session& session, std::size_t scan, std::vector<float>* buffer) {
  if (session.ranges == nullptr) return session.scans[scan].ranges_m;
  session.ranges->Read(scan, buffer);
  return *buffer;
}

std::vector<ScanStamp> StampsOfScans(const Session& session) {
  std::vector<ScanStamp> stamps;
  stamps.reserve(session.scans.size());
  for (const Scan& scan : session.scans) stamps.push_back({scan.stamp_ns, scan.stamp_ns - scan.clock_repair_ns});
  return stamps;
}

std::vector<StampNs> ClockStamps(const std::vector<ScanStamp>& stamps) {
  std::vector<StampNs> clock;
  clock.reserve(stamps.size());
  for (const ScanStamp& stamp : stamps) clock.push_back(stamp.clock_ns);
  return clock;
}

}  // namespace survey
