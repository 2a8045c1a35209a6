// SPDX-License-Identifier: Apache-2.0
#include "formats/starnet_line.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/angle_text.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {

StarnetLine::StarnetLine(std::string where, std::string text) : where_(std::move(where)) {
  text = text.substr(0, text.find('#'));
  text = text.substr(0, text.find('\''));
  for (std::size_t begin = text.find_first_not_of(" \t"); begin != std::string::npos;
       begin = text.find_first_not_of(" \t", begin)) {
    const std::size_t end = std::min(text.find_first_of(" \t", begin), text.size());
    words_.push_back(text.substr(begin, end - begin));
    begin = end;
  }
}

void StarnetLine::Fail(const std::string& rule) const { throw DataError(where_ + rule); }

void StarnetLine::RefuseMore(const std::string& code) const {
  if (More()) Fail("\"" + Peek() + "\" is one value too many for a line of type " + code);
}

const std::string& StarnetLine::Word(const std::string& what) {
  if (!More()) Fail(what + " is missing");
  return words_[next_++];
}

double StarnetLine::Number(const std::string& what) {
  const std::string& text = Word(what);
  const std::optional<double> value = ParseNumber(text);
  if (!value) Fail(what + " = \"" + text + "\": " + WhyNotANumber(text));
  return *value;
}

double StarnetLine::Angle(const std::string& what) {
  const std::string& text = Word(what);
  std::optional<double> angle = ParseDms(text);
  if (!angle && text.find_first_not_of("0123456789") == std::string::npos) {
    angle = ParseNumber(text).value_or(0.0) * kRadPerDegree;
  }
  if (!angle) Fail(what + " = \"" + text + "\": must be degrees-minutes-seconds, as 123-45-06.7");
  return *angle;
}

double StarnetLine::Bearing(const std::string& what) {
  std::string text = Word(what);
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const char first = text.front(), last = text.back();
  if (first != 'N' && first != 'S') {
    --next_;
    return Angle(what);
  }
  const std::optional<double> angle = text.size() > 2 ? ParseDms(text.substr(1, text.size() - 2)) : std::nullopt;
  if (!angle || (last != 'E' && last != 'W')) Fail(what + " = \"" + text + "\": must be as N12-30-20E");
  const double east = last == 'E' ? *angle : -*angle;
  return first == 'N' ? east : M_PI - east;
}

std::vector<std::string> StarnetLine::Names(std::size_t count, char separator) {
  const std::string& text = Word("the names of the stations");
  std::vector<std::string> names(1);
  for (const char c : text) {
    if (c == separator) {
      names.emplace_back();
    } else {
      names.back() += c;
    }
  }
  if (names.size() != count) {
    Fail("\"" + text + "\": expected " + std::to_string(count) + " station names with \"" + separator + "\" between");
  }
  return names;
}

}  // namespace formats
