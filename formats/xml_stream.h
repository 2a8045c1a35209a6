// SPDX-License-Identifier: Apache-2.0
//
// XML files of any size, element by element. Refused: entity declarations (their expansion can blow up a small file),
// external entities, elements nested deeper than 50, single texts of more than 256 MB. A file that says nothing of its
// encoding, or says UTF-8, and is not UTF-8, is read as Latin-1 with a warning.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace formats {

class XmlElement {
 public:
  XmlElement(std::string where, std::string name) : where_(std::move(where)), name_(std::move(name)) {}

  const std::string& name() const { return name_; }    // without namespace prefix
  const std::string& where() const { return where_; }  // "file:line: "
  void Add(std::string attribute, std::string value) { attributes_.emplace(std::move(attribute), std::move(value)); }

  // Attributes, without blanks at their ends; empty when missing. Asking for one marks it as known.
  std::string Text(const std::string& attribute);
  std::string NeededText(const std::string& attribute);
  bool Has(const std::string& attribute) const { return attributes_.contains(attribute); }
  double Number(const std::string& attribute, double default_value);
  double NeededNumber(const std::string& attribute);
  int NeededCount(const std::string& attribute);  // a whole number from 0 to a million
  // DataError when there is an attribute that was not asked for.
  void RefuseOthers() const;
  [[noreturn]] void Fail(const std::string& what) const;

 private:
  std::string where_;
  std::string name_;
  std::map<std::string, std::string> attributes_;
  std::map<std::string, bool> known_;
};

struct XmlHandlers {
  std::function<void(XmlElement& element)> start;
  // Called with the text between start and end, without that of elements inside.
  std::function<void(const std::string& name, const std::string& text, const std::string& where)> end;
};

// Warnings are appended. DataError names file, line and what is wrong.
void ReadXml(const std::filesystem::path& file, const XmlHandlers& handlers, std::vector<std::string>* warnings);

// All numbers of a text, separated by white space. DataError begins with `where`.
std::vector<double> NumbersOf(std::string_view text, const std::string& where);

}  // namespace formats
