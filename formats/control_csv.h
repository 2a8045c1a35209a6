// SPDX-License-Identifier: Apache-2.0
//
// Control lists as survey offices keep them, one point a row, metres:
//   named columns
//   point,northing,easting[,elevation][,sigma_n,sigma_e][,cov_en][,sigma_h][,description][,role][,reason],
//                  in any order
//   no header      P,N,E[,Z[,D]] (PNEZD), P,E,N[,Z[,D]] (PENZD) or ID,X,Y,Z,... (NavVis: x east, y north; what follows
//                  is ignored); which of them must be told, it is never guessed
// In .txt files blanks or tabs may stand for the commas of a list without a header.
// '#' starts a comment line; a byte-order mark, CRLF and quoted fields are understood; text that is not UTF-8 is taken
// for Latin-1. role is control (also when empty), check, tie or excluded; only tie points may lack coordinates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/control/control_point.h"

namespace formats {

struct ControlCsvOptions {
  std::string order;               // of a file without a header: "pnezd", "penzd" or "navvis"; empty = not told
  double default_sigma_m = 0.002;  // 1 sigma per axis, where the file has no sigma columns
  std::string crs;                 // when given, axes that look exchanged are found by its area of use
};

struct ControlCsv {
  std::vector<survey::ControlPoint> points;  // in order of their names
  int num_default_sigmas = 0;                // points that took default_sigma_m
  std::vector<std::string> warnings;
};

// DataError names file, row, field, value and rule.
ControlCsv ReadControlCsv(const std::filesystem::path& file, const ControlCsvOptions& options);

}  // namespace formats
