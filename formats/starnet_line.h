// SPDX-License-Identifier: Apache-2.0
//
// One line of a STAR*NET data file: words separated by blanks; '#' begins a comment, an apostrophe a description.
#pragma once

#include <string>
#include <vector>

namespace formats {

class StarnetLine {
 public:
  StarnetLine() = default;
  StarnetLine(std::string where, std::string text);  // where: "file:17: "

  const std::string& where() const { return where_; }
  bool More() const { return next_ < words_.size(); }
  const std::string& Peek() const { return words_[next_]; }
  void SkipRest() { next_ = words_.size(); }
  void RefuseMore(const std::string& code) const;

  // The next word; DataError when there is none or it is not what is expected. `what` names it in messages.
  const std::string& Word(const std::string& what);
  double Number(const std::string& what);
  double Angle(const std::string& what);    // d-m-s or whole degrees, to rad
  double Bearing(const std::string& what);  // N12-30-20E, or an azimuth, to rad
  std::vector<std::string> Names(std::size_t count, char separator);

  [[noreturn]] void Fail(const std::string& rule) const;

 private:
  std::string where_;
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

}  // namespace formats
