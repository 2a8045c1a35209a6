// SPDX-License-Identifier: Apache-2.0
#include "formats/starnet_settings.h"

#include <cctype>
#include <map>

namespace formats {
namespace {

constexpr double kMetresPerFoot = 0.3048;
constexpr double kMetresPerUsFoot = 1200.0 / 3937.0;

bool OnOff(StarnetLine* line) {
  const std::string text = Upper(line->Word("ON or OFF"));
  if (text != "ON" && text != "OFF") line->Fail("\"" + text + "\": must be ON or OFF");
  return text == "ON";
}

char Separator(StarnetLine* line) {
  const std::string& text = line->Word("the separator");
  if (text.size() != 1) line->Fail("\"" + text + "\": the separator is one character");
  return text[0];
}

}  // namespace

std::string Upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

void StarnetSettings::Read(const std::string& code, StarnetLine* line) {
  if (code == ".UNITS") {
    ReadUnits(line);
  } else if (code == ".ORDER") {
    ReadOrder(line);
  } else if (code == ".2D" || code == ".3D") {
    dimensions = code == ".2D" ? 2 : 3;
  } else if (code == ".DELTA") {
    delta = OnOff(line);
  } else if (code == ".DATA") {
    data_on = OnOff(line);
  } else if (code == ".SEP" || code == ".SEPARATOR") {
    separator = Separator(line);
  } else if (code == ".END") {
    ended = true;
  } else {
    line->Fail("the inline option " + code +
               " is not known here; known are .UNITS, .ORDER, .2D, .3D, .DELTA, .DATA, .SEP, .END");
  }
}

void StarnetSettings::RequireComplete(const StarnetLine& line) const {
  if (!units_known_) line.Fail("the file must state its unit of length before the first data line: .UNITS METERS");
  if (dimensions == 0) line.Fail("the file must state .2D or .3D before the first data line");
}

void StarnetSettings::ReadUnits(StarnetLine* line) {
  static const std::map<std::string, double> kLengths = {{"METERS", 1.0},
                                                         {"METRES", 1.0},
                                                         {"FEET", kMetresPerFoot},
                                                         {"INTERNATIONALFEET", kMetresPerFoot},
                                                         {"USFEET", kMetresPerUsFoot}};
  while (line->More()) {
    const std::string text = Upper(line->Word("a word"));
    if (const auto found = kLengths.find(text); found != kLengths.end()) {
      metres_per_unit = found->second;
      units_known_ = true;
    } else if (text != "DMS") {
      line->Fail("unit \"" + text + "\": must be METERS, FEET (international), USFEET or DMS");
    }
  }
}

void StarnetSettings::ReadOrder(StarnetLine* line) {
  while (line->More()) {
    const std::string text = Upper(line->Word("a word"));
    if (text == "NE" || text == "EN") {
      north_first = text == "NE";
    } else if (text == "ATFROMTO" || text == "FROMATTO") {
      at_first = text == "ATFROMTO";
    } else {
      line->Fail("order \"" + text + "\": must be NE, EN, ATFROMTO or FROMATTO");
    }
  }
}

}  // namespace formats
