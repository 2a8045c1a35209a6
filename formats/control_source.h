// SPDX-License-Identifier: Apache-2.0
//
// A site's control in whatever file an office keeps it: lists of points (CSV, TXT, LandXML), another program's
// adjustment (GNU Gama XML), or observations to be adjusted (GNU Gama .gkf, STAR*NET .dat).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/control_csv.h"
#include "formats/network_file.h"
#include "survey/control/control_point.h"

namespace formats {

struct ControlSourceOptions {
  ControlCsvOptions csv;  // its default sigma and CRS serve the other kinds too
  StarnetSigmas starnet;
};

struct ControlSource {
  survey::ControlNetwork control;      // points (with correlations and summary), unless there are observations
  std::optional<NetworkFile> network;  // observations
  int num_default_sigmas = 0;
  std::vector<std::string> warnings;
};

// The kind goes by the file's extension (.csv, .txt, .gkf, .dat) and, for .xml, by its root element. DataError names
// file, line, value and rule.
ControlSource ReadControlSource(const std::filesystem::path& file, const ControlSourceOptions& options);

// Whether ReadControlSource knows the extension.
bool IsControlSource(const std::filesystem::path& file);
bool IsPointList(const std::filesystem::path& file);  // .csv or .txt

struct PointRoleRow {
  std::string point;
  survey::PointRole role = survey::PointRole::kControl;
  std::string reason;
  std::string where;  // "file:row"
};

// A list of roles for control that comes without: header point,role,reason.
std::vector<PointRoleRow> ReadRolesCsv(const std::filesystem::path& file);

}  // namespace formats
