// SPDX-License-Identifier: Apache-2.0
#include "formats/control_landxml.h"

#include <algorithm>
#include <map>

#include "formats/control_limits.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"
#include "formats/xml_stream.h"

namespace formats {
namespace {

class LandXmlReader {
 public:
  explicit LandXmlReader(const std::filesystem::path& file) : file_(file) {}

  LandXmlFile Read() {
    ReadXml(file_,
            {.start = [this](XmlElement& element) { Start(element); },
             .end =
                 [this](const std::string& name, const std::string& text, const std::string& where) {
                   if (name == "CgPoint") End(text, where);
                 }},
            &result_.warnings);
    if (result_.points.empty()) throw DataError(file_.string() + ": holds no CgPoint");
    if (num_references_ > 0) {
      result_.warnings.push_back(file_.string() + ": " + std::to_string(num_references_) +
                                 " CgPoints refer to other points; left out");
    }
    if (!metres_per_unit_) throw DataError(file_.string() + ": <Units> does not state a linear unit");
    for (LandXmlPoint& point : result_.points) {
      point.east_north *= *metres_per_unit_;
      if (point.elevation_m) *point.elevation_m *= *metres_per_unit_;
    }
    std::sort(result_.points.begin(), result_.points.end(),
              [](const LandXmlPoint& a, const LandXmlPoint& b) { return a.name < b.name; });
    return std::move(result_);
  }

 private:
  void Start(XmlElement& element) {
    const std::string& name = element.name();
    if (depth_++ == 0 && name != "LandXML") element.Fail("is no LandXML file");
    if (name == "Metric" || name == "Imperial") return ReadUnit(element);
    if (name == "CoordinateSystem") result_.epsg_code = element.Text("epsgCode");
    if (name != "CgPoint") return;
    point_ = {};
    reference_ = !element.Text("pntRef").empty();
    point_.name = element.Text("name");
    if (point_.name.empty() && !reference_) element.Fail("attribute name is missing");
    point_.description = element.Text("desc");
    if (point_.description.empty()) point_.description = element.Text("code");
  }

  void ReadUnit(XmlElement& element) {
    static const std::map<std::string, double> kUnits = {{"meter", 1.0},       {"metre", 1.0},
                                                         {"millimeter", 1e-3}, {"centimeter", 1e-2},
                                                         {"foot", 0.3048},     {"USSurveyFoot", 1200.0 / 3937.0}};
    const std::string unit = element.NeededText("linearUnit");
    const auto found = kUnits.find(unit);
    if (found == kUnits.end()) element.Fail("linearUnit = \"" + unit + "\": is not known");
    metres_per_unit_ = found->second;
  }

  void End(const std::string& text, const std::string& where) {
    if (reference_) {
      ++num_references_;
      return;
    }
    const std::vector<double> numbers = NumbersOf(text, where);
    if (numbers.size() != 2 && numbers.size() != 3) {
      throw DataError(where + "point " + point_.name + ": expected northing, easting and perhaps elevation, found " +
                      std::to_string(numbers.size()) + " numbers");
    }
    point_.east_north = {numbers[1], numbers[0]};
    if (numbers.size() == 3) point_.elevation_m = numbers[2];
    const auto [known, is_new] = coordinates_.emplace(point_.name, numbers);
    if (is_new) {
      result_.points.push_back(point_);
      RequireAtMost(kMostControlPoints, result_.points.size(), "points", where);
    } else if (known->second != numbers) {
      throw DataError(where + "point " + point_.name + " is there twice with different coordinates");
    }
  }

  const std::filesystem::path& file_;
  LandXmlFile result_;
  int depth_ = 0;
  LandXmlPoint point_;
  bool reference_ = false;
  int num_references_ = 0;
  std::optional<double> metres_per_unit_;
  std::map<std::string, std::vector<double>> coordinates_;
};

}  // namespace

LandXmlFile ReadLandXml(const std::filesystem::path& file) { return LandXmlReader(file).Read(); }

}  // namespace formats
