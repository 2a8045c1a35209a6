// SPDX-License-Identifier: Apache-2.0
#include "formats/carmen_messages.h"

#include <array>

#include "formats/errors.h"
#include "formats/line_reader.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

using survey::Pose2;

// One line, word by word. Throws DataError with the reason only; the caller adds file and row.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) { name_ = Next("message name"); }

  const std::string& name() const { return name_; }
  bool empty() const { return Trimmed(rest_).empty(); }

  std::string_view Next(const char* field) {
    rest_ = Trimmed(rest_);
    if (rest_.empty()) throw DataError(name_ + ": ends before " + field);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t"));
    rest_.remove_prefix(word.size());
    return word;
  }

  double Number(const char* field) {
    const std::string_view word = Next(field);
    const std::optional<double> value = ParseNumber(word);
    if (!value) Refuse(field, word, WhyNotANumber(word));
    return *value;
  }

  // A count, then as many numbers. Nothing is allocated on the word of the count alone.
  std::vector<float> Numbers(const char* count_field, const char* field) {
    const std::string_view word = Next(count_field);
    const std::optional<long long> count = ParseInteger(word);
    if (!count || *count < 0 || *count > kMostBeams) {
      Refuse(count_field, word, "must be a whole number from 0 to " + std::to_string(kMostBeams));
    }
    std::vector<float> numbers = PlainNumbers(static_cast<std::size_t>(*count));
    for (auto i = static_cast<long long>(numbers.size()); i < *count; ++i) {
      if (empty()) {
        throw DataError(name_ + ": wrong beam count: found " + std::to_string(i) + " " + field + ", expected " +
                        std::to_string(*count));
      }
      const std::string_view text = Next(field);
      const std::optional<float> value = ParseFloat(text);
      if (!value) Refuse((std::string(field) + " " + std::to_string(i)).c_str(), text, WhyNotANumber(text));
      numbers.push_back(*value);
    }
    return numbers;
  }

  Pose2 Pose(const char* field) {
    const double x = Number(field);
    const double y = Number(field);
    return {x, y, Number(field)};
  }

  // ipc_timestamp ipc_hostname logger_timestamp, the last words of a line.
  template <typename Message>
  void Trailer(Message* message) {
    message->stamp_ns = Stamp("ipc_timestamp", " (more ranges than the count says?)");
    Next("ipc_hostname");
    message->logger_ns = Stamp("logger_timestamp", "");
    if (!empty()) throw DataError(name_ + ": more fields than the message has (wrong beam count?)");
  }

 private:
  static constexpr long long kMostBeams = 100'000;

  // Takes numbers for as long as they are plain and a blank apart.
  std::vector<float> PlainNumbers(std::size_t most) {
    const char* next = rest_.data();
    const char* const end = next + rest_.size();
    std::vector<float> numbers;
    while (numbers.size() < most && next != end && *next == ' ') {
      float number = 0.0F;
      const char* const stop = ScanPlainNumber(next + 1, end, &number);
      if (stop == nullptr || stop == end || *stop != ' ') break;
      numbers.push_back(number);
      next = stop;
    }
    rest_.remove_prefix(static_cast<std::size_t>(next - rest_.data()));
    return numbers;
  }

  survey::StampNs Stamp(const char* field, const char* hint) {
    const std::string_view word = Next(field);
    const std::optional<survey::StampNs> stamp = ParseStamp(word);
    if (!stamp) Refuse(field, word, WhyNotANumber(word) + hint);
    return *stamp;
  }

  [[noreturn]] void Refuse(const char* field, std::string_view word, const std::string& rule) const {
    throw DataError(name_ + ": " + field + " = \"" + std::string(word.substr(0, 40)) + "\": " + rule);
  }

  std::string_view rest_;
  std::string name_;
};

void ParseOdometry(Words* words, CarmenOdometry* odometry) {
  odometry->odom_from_body = words->Pose("x y theta");
  for (const char* field : {"tv", "rv", "accel"}) words->Number(field);
  words->Trailer(odometry);
}

void ParseOldLaser(Words* words, CarmenLaser* laser) {
  laser->ranges_m = words->Numbers("num_readings", "ranges");
  laser->odom_from_lidar = words->Pose("x y theta");
  laser->odom_from_body = words->Pose("odom_x odom_y odom_theta");
  words->Trailer(laser);
}

void ParseStatedGeometry(Words* words, CarmenLaser* laser) {
  laser->states_geometry = true;
  laser->is_sick_lms = words->Number("laser_type") == 0;
  laser->start_angle_rad = words->Number("start_angle");
  words->Number("field_of_view");
  laser->resolution_rad = words->Number("angular_resolution");
  if (laser->resolution_rad == 0) throw DataError(words->name() + ": angular_resolution = 0: must not be 0");
  laser->range_max_m = words->Number("maximum_range");
  if (laser->range_max_m <= 0) throw DataError(words->name() + ": maximum_range: must be positive");
  words->Number("accuracy");
  words->Number("remission_mode");
  laser->ranges_m = words->Numbers("num_readings", "ranges");
  words->Numbers("num_remissions", "remissions");
}

void ParseRawLaser(Words* words, CarmenLaser* laser) {
  ParseStatedGeometry(words, laser);
  words->Trailer(laser);
}

void ParseRobotLaser(Words* words, CarmenLaser* laser) {
  ParseStatedGeometry(words, laser);
  laser->odom_from_lidar = words->Pose("laser_pose");
  laser->odom_from_body = words->Pose("robot_pose");
  for (const char* field : {"laser_tv", "laser_rv", "forward_safety_dist", "side_safety_dist", "turn_axis"})
    words->Number(field);
  words->Trailer(laser);
}

using LaserParser = void (*)(Words*, CarmenLaser*);

LaserParser ParserOf(const std::string& message) {
  if (message == "FLASER" || message == "RLASER") return ParseOldLaser;
  if (message == "ROBOTLASER1" || message == "ROBOTLASER2") return ParseRobotLaser;
  if (message == "RAWLASER1" || message == "RAWLASER2") return ParseRawLaser;
  return nullptr;
}

// Returns false when the message is of no use here.
bool ParseLine(std::string_view line, int row, CarmenMessages* messages) {
  Words words(line);
  if (words.name() == "ODOM") {
    CarmenOdometry odometry{.row = row};
    ParseOdometry(&words, &odometry);
    messages->odometry.push_back(odometry);
    return true;
  }
  if (words.name() == "PARAM") {
    const std::string name(words.Next("param_name"));
    if (!name.starts_with("robot_frontlaser_") && !name.starts_with("robot_rearlaser_")) return false;
    const std::optional<double> value = ParseNumber(words.Next("param_value"));
    if (value) messages->laser_params[name] = *value;
    return value.has_value();
  }
  const LaserParser parse = ParserOf(words.name());
  if (parse == nullptr) return false;
  CarmenLaser laser{.row = row};
  parse(&words, &laser);
  messages->lasers[words.name()].push_back(std::move(laser));
  return true;
}

}  // namespace

CarmenMessages ReadCarmenMessages(const std::filesystem::path& file) {
  LineReader lines(file);
  CarmenMessages messages;
  std::string_view line;
  bool any = false;
  while (lines.Next(&line)) {
    line = Trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    try {
      any = ParseLine(line, lines.line_number(), &messages) || any;
    } catch (const DataError& error) {
      const std::string what = lines.Where() + ": " + error.what();
      if (lines.line_was_ended()) throw DataError(what);
      messages.cut_off = what;
    }
  }
  if (!any && messages.cut_off.empty()) {
    throw DataError(file.string() +
                    ": holds no CARMEN message that is understood (FLASER, RLASER, ROBOTLASER1, RAWLASER1, ODOM, ...)");
  }
  return messages;
}

}  // namespace formats
