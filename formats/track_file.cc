// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"
#include "formats/navigation_table.h"
#include "formats/scans_table.h"

namespace formats {
namespace {

using survey::Prediction;

constexpr std::array kPredictions = {Prediction::kStart, Prediction::kOdometry, Prediction::kInertial,
                                     Prediction::kConstantVelocity};

constexpr auto kScanRow = [](auto& row, auto& stamp, auto& scan) {
  row(scan.scan, stamp, scan.local_from_scan, scan.covariance, Named{scan.prediction, kPredictions}, scan.matched,
      scan.is_node, scan.score);
};
constexpr auto kConstraintRow = [](auto& row, auto& id, auto& constraint) { row(id, constraint); };
constexpr auto kMarkRow = [](auto& row, auto& id, auto& mark) {
  row(id, mark.point, mark.start_ns, mark.end_ns, mark.scan, mark.mark_in_scan, mark.covariance);
};
constexpr auto kRequestRow = [](auto& row, auto& id, auto& request) {
  row(id, request.scan, request.cause, request.doubt, request.message);
};

void WriteModes(ArtefactWriter& writer, const std::vector<survey::ReviewRequest>& requests) {
  writer.Table("request_modes", [&](TableWriter& row) {
    int id = 0;
    for (std::size_t request = 0; request < requests.size(); ++request) {
      for (const survey::RequestMode& mode : requests[request].modes)
        row(id++, request, mode.local_from_scan, mode.weight);
    }
  });
}

void ReadModes(ArtefactReader& reader, std::vector<survey::ReviewRequest>* requests) {
  reader.Table("request_modes", [&](TableReader& row) {
    int id = -1;
    std::size_t request = 0;
    survey::RequestMode mode;
    row(id, request, mode.local_from_scan, mode.weight);
    row.Require(request < requests->size(), "unknown request");
    (*requests)[request].modes.push_back(mode);
  });
}

void WriteSubmaps(ArtefactWriter& writer, const std::vector<survey::Submap>& submaps) {
  writer.Table("submaps", [&](TableWriter& row) {
    for (const survey::Submap& submap : submaps) row(submap.id, submap.local_from_submap);
  });
  writer.Table("submap_nodes", [&](TableWriter& row) {
    int id = 0;
    for (const survey::Submap& submap : submaps) {
      for (const survey::ScanId scan : submap.nodes) row(id++, submap.id, scan);
    }
  });
}

std::vector<survey::Submap> ReadSubmaps(ArtefactReader& reader) {
  std::vector<survey::Submap> submaps;
  reader.Table("submaps", [&](TableReader& row) {
    survey::Submap& submap = submaps.emplace_back();
    row(submap.id, submap.local_from_submap);
  });
  auto submap = submaps.begin();
  reader.Table("submap_nodes", [&](TableReader& row) {
    int id = -1;
    survey::SubmapId submap_id;
    survey::ScanId scan;
    row(id, submap_id, scan);
    while (submap != submaps.end() && submap->id != submap_id) ++submap;
    row.Require(submap != submaps.end(), "nodes must be in order of their submaps");
    submap->nodes.push_back(scan);
  });
  return submaps;
}

}  // namespace

void WriteTrack(const std::filesystem::path& file, const survey::Track& track,
                const std::vector<survey::ScanStamp>& scan_stamps, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kTrack, provenance);
  WriteScans(writer, track.scans, scan_stamps, kScanRow);
  WriteSubmaps(writer, track.submaps);
  WriteRows(writer, "constraints", track.constraints, kConstraintRow);
  WriteRows(writer, "marks", track.marks, kMarkRow);
  WriteRows(writer, "requests", track.requests, kRequestRow);
  WriteModes(writer, track.requests);
  WriteOneRow(writer, "navigation", track.navigation, kNavigationRow);
  writer.Commit();
}

survey::Track ReadTrack(const std::filesystem::path& file, std::vector<survey::ScanStamp>* scan_stamps) {
  if (scan_stamps != nullptr) scan_stamps->clear();
  ArtefactReader reader(file, ArtefactKind::kTrack);
  survey::Track track;
  track.scans = ReadScans<survey::TrackedScan>(reader, kScanRow, scan_stamps);
  track.submaps = ReadSubmaps(reader);
  track.constraints = ReadRows<survey::SubmapConstraint>(reader, "constraints", kConstraintRow);
  track.marks = ReadRows<survey::TrackedMark>(reader, "marks", kMarkRow);
  track.requests = ReadRows<survey::ReviewRequest>(reader, "requests", kRequestRow);
  ReadModes(reader, &track.requests);
  track.navigation = ReadOneRow<survey::NavigationSummary>(reader, "navigation", kNavigationRow);
  return track;
}

}  // namespace formats
