// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "formats/artefact_file.h"
#include "formats/artefact_text.h"
#include "formats/artefacts.h"
#include "formats/errors.h"
#include "formats/text_table.h"

namespace formats {
namespace {

std::vector<survey::Pose2> PosesOf(const std::filesystem::path& file) {
  std::vector<survey::Pose2> poses;
  const ArtefactKind kind = KindOfArtefact(file);
  if (kind == ArtefactKind::kTrack) {
    for (const survey::TrackedScan& scan : ReadTrack(file).scans) poses.push_back(scan.local_from_scan);
  } else if (kind == ArtefactKind::kSolution) {
    for (const survey::SolvedScan& scan : ReadSolution(file).scans) poses.push_back(scan.site_from_scan);
  } else {
    throw DataError(file.string() + ": a " + std::string(FormatOf(kind).name) +
                    " file has no trajectory; --trajectory works on track.sqlite and solution.sqlite");
  }
  return poses;
}

}  // namespace

void PrintTumTrajectory(const std::filesystem::path& file, std::ostream& out) {
  if (KindOfFile(file) != FileKind::kSqlite)
    throw DataError(file.string() + ": --trajectory works on track.sqlite and solution.sqlite");
  const std::vector<survey::Pose2> poses = PosesOf(file);
  const std::vector<survey::ScanStamp> stamps = ReadScanStamps(file);
  std::vector<std::pair<survey::StampNs, survey::Pose2>> lines;
  for (std::size_t i = 0; i < poses.size(); ++i) lines.emplace_back(stamps[i].recorded_ns, poses[i]);
  std::stable_sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [stamp, pose] : lines) {
    out << SecondsOfNs(stamp) << " " << Number(pose.x, "%.9f") << " " << Number(pose.y, "%.9f") << " 0 0 0 "
        << Number(std::sin(0.5 * pose.theta), "%.12f") << " " << Number(std::cos(0.5 * pose.theta), "%.12f") << "\n";
  }
}

}  // namespace formats
