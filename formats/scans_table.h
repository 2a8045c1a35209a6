// SPDX-License-Identifier: Apache-2.0
//
// Table `scans` of tracks and solutions: one row per scan of the session, its index and its stamps first.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "formats/artefact_file.h"

namespace formats {

// row_function(table, stamp, scan) lists the columns; `scan` has the member `scan`, its ScanId.
template <typename Scan, typename RowFunction>
void WriteScans(ArtefactWriter& writer, const std::vector<Scan>& scans, const std::vector<survey::ScanStamp>& stamps,
                RowFunction row_function) {
  if (scans.size() != stamps.size()) throw std::logic_error("as many stamps as scans are needed");
  writer.Table("scans", [&](TableWriter& row) {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      if (scans[i].scan.value != static_cast<int>(i)) throw std::logic_error("scans must stand in their order");
      row_function(row, stamps[i], scans[i]);
    }
  });
}

// `stamps`: gets theirs; null: they are not wanted.
template <typename Scan, typename RowFunction>
std::vector<Scan> ReadScans(ArtefactReader& reader, RowFunction row_function,
                            std::vector<survey::ScanStamp>* stamps = nullptr) {
  std::vector<Scan> scans;
  reader.Table("scans", [&](TableReader& row) {
    survey::ScanStamp stamp;
    row_function(row, stamp, scans.emplace_back());
    row.Require(scans.back().scan.value == row.row(), "scans must count from 0");
    if (stamps != nullptr) stamps->push_back(stamp);
  });
  return scans;
}

}  // namespace formats
