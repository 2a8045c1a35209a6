// SPDX-License-Identifier: Apache-2.0
//
// What the inline options of a STAR*NET file (.UNITS, .ORDER, .2D, .3D, .DELTA, .DATA, .SEP, .END) say about its lines.
#pragma once

#include <optional>
#include <string>

#include "formats/starnet_line.h"

namespace formats {

class StarnetSettings {
 public:
  // `code` is the option's name in capitals, its values follow on the line. DataError for unknown options and values.
  void Read(const std::string& code, StarnetLine* line);

  // DataError where unit and dimension are not told yet: they are never guessed.
  void RequireComplete(const StarnetLine& line) const;

  double metres_per_unit = 1.0;
  int dimensions = 0;
  std::optional<bool> north_first;
  bool at_first = true;  // stations of an angle: at, from, to
  bool delta = false;    // distances are horizontal and vertical observations are height differences
  bool data_on = true;   // lines count
  bool ended = false;
  char separator = '-';

 private:
  void ReadUnits(StarnetLine* line);
  void ReadOrder(StarnetLine* line);

  bool units_known_ = false;
};

// In capitals.
std::string Upper(std::string text);

}  // namespace formats
