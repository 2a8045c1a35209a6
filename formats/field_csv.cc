// SPDX-License-Identifier: Apache-2.0
#include "formats/field_csv.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>

#include "formats/atomic_file.h"
#include "formats/csv.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::Mark;
using survey::Scan;
using survey::ScanGeometry;
using survey::StampNs;

// The keys of the first line of scans.csv.
std::map<std::string, double*> HeaderKeys(ScanGeometry* geometry) {
  return {{"angle_min", &geometry->angle_min_rad},
          {"angle_increment", &geometry->angle_increment_rad},
          {"time_increment", &geometry->time_increment_s},
          {"range_min", &geometry->range_min_m},
          {"range_max", &geometry->range_max_m}};
}

constexpr const char* kHeaderForm =
    "# angle_min=... angle_increment=... time_increment=... range_min=... range_max=...";

void CheckHeader(const CsvReader& csv, const ScanGeometry& geometry) {
  const auto require = [&](bool holds, const char* key, double value, const char* rule) {
    if (!holds) csv.FailRow(std::string(key) + " = " + NumberText(value) + ": " + rule);
  };
  require(std::abs(geometry.angle_min_rad) <= 2 * std::numbers::pi, "angle_min", geometry.angle_min_rad,
          "radians, must be within one turn (degrees?)");
  require(geometry.angle_increment_rad != 0, "angle_increment", geometry.angle_increment_rad, "must not be 0");
  require(geometry.time_increment_s >= 0, "time_increment", geometry.time_increment_s, "must not be negative");
  require(geometry.range_min_m >= 0, "range_min", geometry.range_min_m, "must not be negative");
  require(geometry.range_max_m > geometry.range_min_m, "range_max", geometry.range_max_m, "must exceed range_min");
}

ScanGeometry ReadScansHeader(CsvReader* csv, const FieldDataOptions& options) {
  std::string_view line;
  if (!csv->NextLine(&line)) throw DataError(csv->file().string() + ": is empty, expected " + kHeaderForm);
  if (!line.starts_with('#')) csv->FailRow(std::string("the first line must be ") + kHeaderForm);
  line.remove_prefix(1);

  ScanGeometry geometry;
  std::map<std::string, double*> missing = HeaderKeys(&geometry);
  while (!(line = Trimmed(line)).empty()) {
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    line.remove_prefix(word.size());
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) csv->FailRow("\"" + std::string(word) + "\": expected key=value");
    const std::string key(word.substr(0, equals));
    const std::string_view text = word.substr(equals + 1);
    const auto found = missing.find(key);
    if (found == missing.end()) {
      const bool known = HeaderKeys(&geometry).contains(key);
      csv->FailRow(key + ": " + (known ? "given twice" : std::string("unknown key; expected ") + kHeaderForm));
    }
    const std::optional<double> value = ParseNumber(text);
    if (!value) csv->FailRow(key + " = \"" + std::string(text) + "\": " + WhyNotANumber(text));
    *found->second = *value;
    missing.erase(found);
  }
  if (!missing.empty()) csv->FailRow(missing.begin()->first + " is missing; expected " + kHeaderForm);
  geometry.range_min_m = options.range_min_m.value_or(geometry.range_min_m);
  geometry.range_max_m = options.range_max_m.value_or(geometry.range_max_m);
  CheckHeader(*csv, geometry);
  return geometry;
}

float RangeWithin(float range, const ScanGeometry& geometry) {
  return range > geometry.range_max_m   ? survey::kNoReturn
         : range < geometry.range_min_m ? survey::kInvalidRange
                                        : range;
}

// A whole scan of plain numbers and empty fields, as programs write it. False for any other row, good or bad.
bool ReadPlainScan(std::string_view row, const ScanGeometry& geometry, Scan* scan) {
  const std::size_t comma = row.find(',');
  if (comma == std::string_view::npos) return false;
  const std::optional<StampNs> stamp = ParseStamp(row.substr(0, comma));
  if (!stamp) return false;
  scan->stamp_ns = *stamp;
  scan->ranges_m.clear();
  scan->ranges_m.reserve(static_cast<std::size_t>(geometry.num_beams));
  const char* next = row.data() + comma;
  const char* const end = row.data() + row.size();
  while (next != end) {
    if (*next++ != ',') return false;
    float range = survey::kNoReturn;
    if (next != end && *next != ',') {
      next = ScanPlainNumber(next, end, &range);
      if (next == nullptr) return false;
      range = RangeWithin(range, geometry);
    }
    scan->ranges_m.push_back(range);
  }
  return scan->ranges_m.size() == static_cast<std::size_t>(geometry.num_beams);
}

std::vector<float> ReadRanges(const CsvReader& csv, const ScanGeometry& geometry) {
  const std::vector<std::string_view>& fields = csv.fields();
  std::vector<float> ranges(fields.size() - 1, survey::kNoReturn);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const std::string_view field = fields[i + 1];
    if (field.empty()) continue;
    const std::optional<float> range = ParseFloat(field);
    if (!range) {
      csv.FailRow("r" + std::to_string(i) + " = \"" + std::string(field.substr(0, 80)) + "\": " + WhyNotANumber(field) +
                  "; leave the field empty where nothing came back");
    }
    ranges[i] = RangeWithin(*range, geometry);
  }
  return ranges;
}

void CheckBeams(const CsvReader& csv, const ScanGeometry& geometry) {
  if (geometry.num_beams < 2) csv.FailRow("the row holds no scan: expected t,r0,r1,...");
  const double span = std::abs(geometry.angle_increment_rad) * (geometry.num_beams - 1);
  if (span > 2 * std::numbers::pi + 1e-6) {
    csv.FailRow(std::to_string(geometry.num_beams) + " ranges at angle_increment=" +
                NumberText(geometry.angle_increment_rad) + " rad span more than one turn");
  }
}

// Stamps grow from row to row.
class StampOrder {
 public:
  void Check(const CsvReader& csv, StampNs stamp) {
    if (!first_ && stamp <= last_) {
      csv.FailRow("t = " + StampText(stamp) + ": time stamps must grow, the row before has " + StampText(last_));
    }
    first_ = false;
    last_ = stamp;
  }

 private:
  bool first_ = true;
  StampNs last_ = 0;
};

// Lines of text into an atomic file.
class TextFile {
 public:
  explicit TextFile(const fs::path& target)
      : target_(target), file_(target), out_(file_.temporary(), std::ios::binary) {}

  void Append(std::string_view text) { out_.write(text.data(), static_cast<std::streamsize>(text.size())); }
  void Close() {
    out_.close();
    if (!out_) throw DataError(target_.string() + ": could not be written (disk full?)");
    file_.Commit();
  }

 private:
  fs::path target_;
  AtomicFile file_;
  std::ofstream out_;
};

void AppendRange(float range, const ScanGeometry& geometry, std::string* line) {
  *line += ',';
  if (range == survey::kNoReturn) return;
  if (std::isnan(range)) {
    *line += geometry.range_min_m > 0 ? "0" : "-1";  // below range_min
    return;
  }
  char buffer[32];
  *line += std::string_view(buffer, std::to_chars(buffer, buffer + sizeof buffer, range).ptr);
}

}  // namespace

ScansCsv ReadScansCsv(const fs::path& file, const FieldDataOptions& options) {
  CsvReader csv(file);
  ScansCsv result{.geometry = ReadScansHeader(&csv, options)};
  StampOrder order;
  std::string_view row;
  while (csv.NextRowText(&row)) {
    Scan scan;
    if (!result.scans.empty() && ReadPlainScan(row, result.geometry, &scan)) {
      order.Check(csv, scan.stamp_ns);
      result.scans.push_back(std::move(scan));
      continue;
    }
    csv.SplitRow();
    const int beams = static_cast<int>(csv.fields().size()) - 1;
    if (result.scans.empty()) {
      result.geometry.num_beams = beams;
      CheckBeams(csv, result.geometry);
    } else if (beams != result.geometry.num_beams) {
      csv.FailRow("wrong beam count: found " + std::to_string(beams) + " ranges, expected " +
                  std::to_string(result.geometry.num_beams) + " as in the first scan");
    }
    const std::optional<StampNs> stamp = ParseStamp(csv.fields()[0]);
    if (!stamp) csv.FailRow("t = \"" + std::string(csv.fields()[0]) + "\": " + WhyNotANumber(csv.fields()[0]));
    order.Check(csv, *stamp);
    result.scans.push_back({.stamp_ns = *stamp, .ranges_m = ReadRanges(csv, result.geometry)});
  }
  return result;
}

std::vector<survey::ImuSample> ReadImuCsv(const fs::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"t", "gx", "gy", "gz", "ax", "ay", "az"});
  StampOrder order;
  std::vector<survey::ImuSample> samples;
  while (csv.NextRow()) {
    samples.push_back({.stamp_ns = csv.Stamp(0),
                       .angular_rate_in_body = {csv.Number(1), csv.Number(2), csv.Number(3)},
                       .specific_force_in_body = {csv.Number(4), csv.Number(5), csv.Number(6)}});
    order.Check(csv, samples.back().stamp_ns);
  }
  return samples;
}

std::vector<survey::OdometrySample> ReadOdometryCsv(const fs::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"t", "x", "y", "theta"});
  StampOrder order;
  std::vector<survey::OdometrySample> samples;
  while (csv.NextRow()) {
    samples.push_back({.stamp_ns = csv.Stamp(0), .odom_from_body = {csv.Number(1), csv.Number(2), csv.Number(3)}});
    order.Check(csv, samples.back().stamp_ns);
  }
  return samples;
}

std::vector<Mark> ReadMarksCsv(const fs::path& file, std::vector<int>* rows) {
  CsvReader csv(file);
  csv.ReadHeader({"point", "start", "end"});
  std::vector<Mark> marks;
  if (rows != nullptr) rows->clear();
  while (csv.NextRow()) {
    Mark mark{.point = std::string(csv.Text(0)), .start_ns = csv.Stamp(1), .end_ns = csv.Stamp(2)};
    if (mark.start_ns >= mark.end_ns) csv.Fail(2, "must come after start = " + StampText(mark.start_ns));
    marks.push_back(std::move(mark));
    if (rows != nullptr) rows->push_back(csv.row());
  }
  return marks;
}

void WriteScansCsv(const fs::path& file, const ScanGeometry& geometry, const std::vector<Scan>& scans) {
  TextFile out(file);
  out.Append("# angle_min=" + NumberText(geometry.angle_min_rad) + " angle_increment=" +
             NumberText(geometry.angle_increment_rad) + " time_increment=" + NumberText(geometry.time_increment_s) +
             " range_min=" + NumberText(geometry.range_min_m) + " range_max=" + NumberText(geometry.range_max_m) +
             "\n");
  std::string line;
  for (const Scan& scan : scans) {
    line = StampText(scan.stamp_ns);
    for (const float range : scan.ranges_m) AppendRange(range, geometry, &line);
    line += '\n';
    out.Append(line);
  }
  out.Close();
}

void WriteImuCsv(const fs::path& file, const std::vector<survey::ImuSample>& samples) {
  TextFile out(file);
  out.Append("t,gx,gy,gz,ax,ay,az\n");
  for (const survey::ImuSample& sample : samples) {
    std::string line = StampText(sample.stamp_ns);
    for (const double value : sample.angular_rate_in_body) line += "," + NumberText(value);
    for (const double value : sample.specific_force_in_body) line += "," + NumberText(value);
    out.Append(line + "\n");
  }
  out.Close();
}

void WriteOdometryCsv(const fs::path& file, const std::vector<survey::OdometrySample>& samples) {
  TextFile out(file);
  out.Append("t,x,y,theta\n");
  for (const survey::OdometrySample& sample : samples) {
    const survey::Pose2& pose = sample.odom_from_body;
    out.Append(StampText(sample.stamp_ns) + "," + NumberText(pose.x) + "," + NumberText(pose.y) + "," +
               NumberText(pose.theta) + "\n");
  }
  out.Close();
}

void WriteMarksCsv(const fs::path& file, const std::vector<Mark>& marks) {
  TextFile out(file);
  out.Append("point,start,end\n");
  for (const Mark& mark : marks)
    out.Append(mark.point + "," + StampText(mark.start_ns) + "," + StampText(mark.end_ns) + "\n");
  out.Close();
}

}  // namespace formats
