// SPDX-License-Identifier: Apache-2.0
#include "formats/control_csv.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "formats/control_limits.h"
#include "formats/crs_area.h"
#include "formats/errors.h"
#include "formats/line_reader.h"
#include "formats/text_encoding.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::ControlPoint;
using survey::PointRole;

constexpr double kLargestSigmaM = 10.0;
constexpr const char* kColumns[] = {"point",       "northing", "easting", "elevation", "sigma_n", "sigma_e",
                                    "description", "role",     "reason",  "cov_en",    "sigma_h"};

struct Row {
  int line = 0;
  std::vector<std::string> fields;
};

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

class Reader {
 public:
  Reader(const fs::path& file, const ControlCsvOptions& options) : file_(file), options_(options) {}

  ControlCsv Read() {
    ReadRows();
    if (rows_.empty()) throw DataError(file_.string() + ": holds no points");
    std::size_t first_point = 0;
    if (options_.order == "navvis" && rows_.front().fields.size() >= 3 && Lower(rows_.front().fields[1]) == "x" &&
        Lower(rows_.front().fields[2]) == "y") {
      SetHeaderlessColumns();
      first_point = 1;
    } else if (HasHeader()) {
      ReadHeader();
      first_point = 1;
    } else {
      SetHeaderlessColumns();
    }
    for (std::size_t i = first_point; i < rows_.size(); ++i) AddPoint(rows_[i]);
    if (lines_.empty()) throw DataError(file_.string() + ": holds a header but no points");
    CheckAxes();
    for (auto& [name, point] : points_) result_.points.push_back(std::move(point));
    return std::move(result_);
  }

 private:
  std::string At(const Row& row) const { return file_.string() + ":" + std::to_string(row.line) + ": "; }

  void ReadRows() {
    LineReader lines(file_);
    bool other_encoding = false;
    for (std::string_view line; lines.Next(&line);) {
      std::string content(Trimmed(line));
      if (content.empty() || content.front() == '#') continue;
      if (!IsUtf8(content)) {
        content = Utf8OfLatin1(content);
        other_encoding = true;
      }
      Row row{.line = lines.line_number()};
      SplitInto(content, &row);
      rows_.push_back(std::move(row));
      RequireAtMost(kMostControlPoints, rows_.size(), "rows", At(rows_.back()));
    }
    if (other_encoding) result_.warnings.push_back(file_.string() + ": is not UTF-8; read as Latin-1");
  }

  // Fields between commas; a quoted one may hold commas and "" for a quote.
  void SplitInto(const std::string& content, Row* row) const {
    std::string field;
    bool quoted = false;
    for (std::size_t i = 0; i < content.size(); ++i) {
      const char c = content[i];
      if (quoted && c == '"' && i + 1 < content.size() && content[i + 1] == '"') {
        field += '"';
        ++i;
      } else if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        row->fields.emplace_back(Trimmed(field));
        field.clear();
      } else {
        field += c;
      }
    }
    if (quoted) throw DataError(At(*row) + "a quoted field is not closed");
    row->fields.emplace_back(Trimmed(field));
    if (row->fields.size() == 1 && Lower(file_.extension().string()) == ".txt" &&
        content.find(';') == std::string::npos) {
      SplitAtBlanks(content, row);
    } else if (row->fields.size() == 1 && content.find_first_of(";\t") != std::string::npos) {
      throw DataError(At(*row) + "\"" + content +
                      "\": fields must be separated by commas and numbers written with a decimal point");
    }
  }

  // Point, coordinates and, as all the rest, a description.
  static void SplitAtBlanks(std::string_view content, Row* row) {
    row->fields.clear();
    while (!content.empty()) {
      const std::size_t end =
          row->fields.size() < 4 ? std::min(content.find_first_of(" \t"), content.size()) : content.size();
      row->fields.emplace_back(content.substr(0, end));
      content = Trimmed(content.substr(end));
    }
  }

  // A first row without any number after its first field names the columns.
  bool HasHeader() const {
    const std::vector<std::string>& first = rows_.front().fields;
    return Lower(first.front()) == "point" || std::none_of(first.begin(), first.end(), [](const std::string& field) {
             return ParseNumber(field).has_value();
           });
  }

  void ReadHeader() {
    const Row& header = rows_.front();
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
      const std::string name = Lower(header.fields[i]);
      if (std::find(std::begin(kColumns), std::end(kColumns), name) == std::end(kColumns)) {
        std::string known;
        for (const char* column : kColumns) known += (known.empty() ? "" : ", ") + std::string(column);
        throw DataError(At(header) + "unknown column \"" + header.fields[i] + "\"; known are " + known +
                        " (a file without a header must start with a row of numbers)");
      }
      if (!columns_.emplace(name, i).second) throw DataError(At(header) + "column \"" + name + "\" appears twice");
    }
    for (const char* needed : {"point", "northing", "easting"}) {
      if (!columns_.contains(needed)) throw DataError(At(header) + "column \"" + needed + "\" is missing");
    }
    if (columns_.contains("sigma_n") != columns_.contains("sigma_e")) {
      throw DataError(At(header) + "sigma_n and sigma_e must come together");
    }
    if (columns_.contains("cov_en") && !columns_.contains("sigma_n")) {
      throw DataError(At(header) + "cov_en needs sigma_n and sigma_e");
    }
    num_columns_ = header.fields.size();
  }

  void SetHeaderlessColumns() {
    const Row& first = rows_.front();
    if (first.fields.size() < 3) {
      throw DataError(At(first) + "expected point and two coordinates, found " + std::to_string(first.fields.size()) +
                      " field(s)");
    }
    if (options_.order.empty()) {
      const std::string &a = first.fields[1], &b = first.fields[2];
      throw DataError(At(first) + "the file has no header, so the order of the coordinates must be told: point " +
                      first.fields[0] + " has northing " + a + ", easting " + b +
                      " with control-order = \"pnezd\", or easting " + a + ", northing " + b +
                      " with control-order = \"penzd\"");
    }
    const bool northing_first = options_.order == "pnezd";
    others_ignored_ = options_.order == "navvis";
    columns_ = {{"point", 0},
                {"northing", northing_first ? 1 : 2},
                {"easting", northing_first ? 2 : 1},
                {"elevation", 3},
                {"description", 4}};
    if (others_ignored_) columns_.erase("description");
    headerless_ = true;
    num_columns_ = 5;
  }

  std::string Field(const Row& row, const std::string& column) const {
    const auto found = columns_.find(column);
    return found == columns_.end() || found->second >= row.fields.size() ? "" : row.fields[found->second];
  }

  std::optional<double> OptionalNumber(const Row& row, const std::string& column) const {
    const std::string text = Field(row, column);
    if (text.empty()) return std::nullopt;
    const std::optional<double> value = ParseNumber(text);
    if (!value) throw DataError(At(row) + column + " = \"" + text + "\": " + WhyNotANumber(text));
    return value;
  }

  double NeededNumber(const Row& row, const std::string& column) const {
    const std::optional<double> value = OptionalNumber(row, column);
    if (!value) throw DataError(At(row) + column + " is missing (point " + Field(row, "point") + ")");
    return *value;
  }

  double Sigma(const Row& row, const std::string& column) const {
    const double sigma = NeededNumber(row, column);
    if (sigma <= 0.0) throw DataError(At(row) + column + " = " + NumberText(sigma) + ": a sigma must be positive (m)");
    if (sigma > kLargestSigmaM) {
      throw DataError(At(row) + column + " = " + NumberText(sigma) + ": a sigma of more than " +
                      NumberText(kLargestSigmaM) + " m is not a control coordinate's; are these millimetres?");
    }
    return sigma;
  }

  void CheckNumberOfFields(const Row& row) const {
    const std::size_t count = row.fields.size();
    if (headerless_ ? count >= 3 && (count <= num_columns_ || others_ignored_) : count == num_columns_) return;
    const bool more = count > num_columns_;
    throw DataError(
        At(row) + std::to_string(count) + " fields, expected " +
        (headerless_ ? "3 to 5 (point, two coordinates, elevation, description)"
                     : std::to_string(num_columns_) + " as in the header") +
        (more ? "; a text with a comma must be in quotes, and numbers need a decimal point, not a comma" : ""));
  }

  PointRole RoleOf(const Row& row) const {
    const std::string text = Lower(Field(row, "role"));
    if (text.empty()) return PointRole::kControl;
    for (const PointRole role : {PointRole::kControl, PointRole::kCheck, PointRole::kTie, PointRole::kExcluded}) {
      if (text == survey::Name(role)) return role;
    }
    throw DataError(At(row) + "role = \"" + Field(row, "role") + "\": must be control, check, tie or excluded");
  }

  Eigen::Matrix2d CovarianceOf(const Row& row) {
    if (!columns_.contains("sigma_n")) {
      ++result_.num_default_sigmas;
      return Eigen::Matrix2d::Identity() * options_.default_sigma_m * options_.default_sigma_m;
    }
    const double sigma_n = Sigma(row, "sigma_n");
    const double sigma_e = Sigma(row, "sigma_e");
    const double cov_en = OptionalNumber(row, "cov_en").value_or(0.0);
    if (std::abs(cov_en) >= sigma_n * sigma_e) {
      throw DataError(At(row) + "cov_en = " + NumberText(cov_en) + ": must be smaller than sigma_n times sigma_e (m2)");
    }
    return (Eigen::Matrix2d() << sigma_e * sigma_e, cov_en, cov_en, sigma_n * sigma_n).finished();
  }

  void AddPoint(const Row& row) {
    CheckNumberOfFields(row);
    ControlPoint point;
    point.name = Field(row, "point");
    if (point.name.empty()) throw DataError(At(row) + "point is missing: a point needs a name");
    point.role = RoleOf(row);
    point.description = Field(row, "description");
    point.reason = Field(row, "reason");
    if (point.role == PointRole::kExcluded && point.reason.empty()) {
      throw DataError(At(row) + "point " + point.name + " is excluded without a reason");
    }
    const bool by_name_only =
        point.role == PointRole::kTie && Field(row, "northing").empty() && Field(row, "easting").empty();
    if (!by_name_only) {
      point.position_in_site = {NeededNumber(row, "easting"), NeededNumber(row, "northing")};
      point.covariance = CovarianceOf(row);
      point.elevation_m = OptionalNumber(row, "elevation");
      if (!Field(row, "sigma_h").empty()) point.elevation_sigma_m = Sigma(row, "sigma_h");
    }
    const auto [previous, is_new] = points_.emplace(point.name, point);
    if (is_new) {
      lines_.emplace(point.name, row.line);
    } else {
      CheckRepeated(row, previous->second, point);
    }
  }

  void CheckRepeated(const Row& row, const ControlPoint& first, const ControlPoint& again) {
    const std::string where =
        At(row) + "point " + again.name + " is already in row " + std::to_string(lines_.at(again.name));
    if (first.position_in_site != again.position_in_site) {
      const auto coordinates = [](const ControlPoint& p) {
        return "northing " + NumberText(p.position_in_site.y()) + ", easting " + NumberText(p.position_in_site.x());
      };
      throw DataError(where + " with other coordinates: there " + coordinates(first) + ", here " + coordinates(again));
    }
    if (first.role != again.role) {
      throw DataError(where + " as " + std::string(survey::Name(first.role)) + ", here it is " +
                      std::string(survey::Name(again.role)) + ": a point has one role");
    }
    if (first.covariance != again.covariance || first.elevation_m != again.elevation_m) {
      throw DataError(where + " with another sigma or elevation");
    }
    result_.warnings.push_back(where + " with the same coordinates; taken once");
  }

  void CheckAxes() {
    std::vector<ControlPoint> points;
    std::vector<std::string> where;
    for (const auto& [name, point] : points_) {
      points.push_back(point);
      where.push_back(file_.string() + ":" + std::to_string(lines_.at(name)) + ": ");
    }
    CheckControlArea(points, options_.crs, where, &result_.warnings);
  }

  const fs::path& file_;
  const ControlCsvOptions& options_;
  std::vector<Row> rows_;
  std::map<std::string, std::size_t> columns_;
  std::size_t num_columns_ = 0;
  bool headerless_ = false;
  bool others_ignored_ = false;  // columns after the fourth
  std::map<std::string, ControlPoint> points_;
  std::map<std::string, int> lines_;
  ControlCsv result_;
};

}  // namespace

ControlCsv ReadControlCsv(const fs::path& file, const ControlCsvOptions& options) {
  return Reader(file, options).Read();
}

}  // namespace formats
