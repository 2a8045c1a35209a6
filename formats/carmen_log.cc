// SPDX-License-Identifier: Apache-2.0
#include "formats/carmen_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "formats/carmen_clock.h"
#include "formats/carmen_messages.h"
#include "formats/carmen_scanner.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

using survey::Pose2;
using survey::ScanGeometry;
using survey::StampNs;

// Best first. The second of each pair looks backwards.
constexpr std::array<const char*, 6> kLaserMessages = {"ROBOTLASER1", "FLASER", "RAWLASER1",
                                                       "ROBOTLASER2", "RLASER", "RAWLASER2"};

bool IsRear(const std::string& message) { return message == "RLASER" || message.ends_with('2'); }

std::string ChooseMessage(const std::string& file, const CarmenMessages& messages, const std::string& wanted,
                          FieldData* data) {
  std::string names;
  std::string chosen;
  for (const char* name : kLaserMessages) {
    if (!messages.lasers.contains(name)) continue;
    names += (names.empty() ? "" : ", ") + std::string(name);
    if (wanted.empty() ? chosen.empty() : wanted == name) chosen = name;
  }
  if (!wanted.empty() && chosen.empty()) {
    throw DataError(file + ": holds no laser message " + wanted + "; it has " + (names.empty() ? "none" : names));
  }
  for (const auto& [name, scans] : messages.lasers) {
    if (name == chosen) continue;
    data->notes.push_back(std::to_string(scans.size()) + " " + name + " scans are not used, but " + chosen +
                          "; scan-topic chooses");
  }
  return chosen;
}

template <typename Message>
std::size_t CountGoingBack(const std::vector<Message>& messages) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < messages.size(); ++i) count += messages[i].stamp_ns < messages[i - 1].stamp_ns ? 1 : 0;
  return count;
}

double RoundedTo(double value, double step) {
  const double rounded = std::round(value / step) * step;
  return rounded == 0 ? 0.0 : rounded;
}

// Where the laser stands on the robot, from the pairs of poses: one place, or nothing.
std::optional<Pose2> MountingFromPoses(const std::vector<CarmenLaser>& lasers) {
  constexpr double kSamePlaceM = 0.002;
  constexpr double kSameAngleRad = 0.002;
  if (lasers.empty() || !lasers.front().odom_from_lidar) return std::nullopt;
  const Pose2 first = survey::Between(*lasers.front().odom_from_body, *lasers.front().odom_from_lidar);
  Pose2 sum;
  for (const CarmenLaser& laser : lasers) {
    const Pose2 here = survey::Between(*laser.odom_from_body, *laser.odom_from_lidar);
    const double turn = survey::NormalizeAngle(here.theta - first.theta);
    if (std::hypot(here.x - first.x, here.y - first.y) > kSamePlaceM || std::abs(turn) > kSameAngleRad)
      return std::nullopt;
    sum = {sum.x + here.x, sum.y + here.y, sum.theta + turn};
  }
  const auto n = static_cast<double>(lasers.size());
  return Pose2{RoundedTo(sum.x / n, 1e-4), RoundedTo(sum.y / n, 1e-4),
               RoundedTo(survey::NormalizeAngle(first.theta + sum.theta / n), 1e-5)};
}

std::optional<Pose2> MountingFromParams(const CarmenMessages& messages, bool rear) {
  const std::string prefix = rear ? "robot_rearlaser_" : "robot_frontlaser_";
  const auto value = [&](const char* name) -> std::optional<double> {
    const auto found = messages.laser_params.find(prefix + name);
    return found == messages.laser_params.end() ? std::nullopt : std::optional(found->second);
  };
  const std::optional<double> offset = value("offset");
  if (!offset) return std::nullopt;
  return Pose2{*offset, value("side_offset").value_or(0.0),
               value("angular_offset").value_or(rear ? std::numbers::pi : 0.0)};
}

void AddMounting(const CarmenMessages& messages, const std::string& name, FieldData* data) {
  const std::vector<CarmenLaser>& lasers = messages.lasers.at(name);
  data->body_from_lidar = MountingFromPoses(lasers);
  if (data->body_from_lidar) return;
  data->body_from_lidar = MountingFromParams(messages, IsRear(name));
  if (lasers.front().odom_from_lidar) {
    data->warnings.push_back(
        "the laser's place on the robot differs from scan to scan (a log with corrected poses?); " +
        std::string(data->body_from_lidar ? "taken from PARAM" : "taken as the robot's centre"));
  }
}

// Limits and beam angles of one scan.
ScanGeometry GeometryOf(const CarmenLaser& laser, const CarmenRangeLimits& limits) {
  ScanGeometry geometry{.range_min_m = limits.min_m, .range_max_m = limits.max_m};
  geometry.num_beams = static_cast<int>(laser.ranges_m.size());
  if (laser.states_geometry) {
    geometry.angle_min_rad = laser.start_angle_rad;
    geometry.angle_increment_rad = UnroundedAngle(laser.resolution_rad);
  } else {
    PlaceBeamsByNumber(&geometry);
  }
  return geometry;
}

void AddScans(std::vector<CarmenLaser>* lasers, const std::vector<StampNs>& repairs, const FieldDataOptions& options,
              FieldData* data) {
  std::vector<const std::vector<float>*> readings;
  for (const CarmenLaser& laser : *lasers) readings.push_back(&laser.ranges_m);
  const CarmenRangeLimits from_readings = LimitsFromReadings(readings);
  bool unknown_scanner = false;
  for (std::size_t i = 0; i < lasers->size(); ++i) {
    CarmenLaser& laser = (*lasers)[i];
    if (laser.ranges_m.size() < 2) {
      data->warnings.push_back("row " + std::to_string(laser.row) + ": a scan of " +
                               std::to_string(laser.ranges_m.size()) + " readings is left out");
      continue;
    }
    CarmenRangeLimits limits = from_readings;
    if (laser.states_geometry) {
      limits = {.max_m = laser.range_max_m,
                .sick_codes = laser.is_sick_lms ? SickUnitOf(laser.range_max_m) : SickUnit::kNone};
    }
    limits.min_m = options.range_min_m.value_or(limits.min_m);
    if (options.range_max_m) limits = {limits.min_m, *options.range_max_m, true, limits.sick_codes};
    const ScanGeometry geometry = GeometryOf(laser, limits);
    unknown_scanner = unknown_scanner || (!laser.states_geometry && !IsKnownNumberOfBeams(geometry.num_beams));
    ClassifyRanges(limits, &laser.ranges_m);
    data->scans.push_back({.stamp_ns = laser.stamp_ns,
                           .geometry = IndexOfGeometry(geometry, &data->geometries),
                           .ranges_m = std::move(laser.ranges_m),
                           .clock_repair_ns = repairs[i]});
  }
  if (unknown_scanner) data->warnings.push_back("scans of no known scanner: their beams are taken to span 180 degrees");
}

// From the laser lines where they carry it: that pose belongs to the scan, whereas ODOM lines must be brought to it by
// clocks that old logging programs did not keep. From ODOM lines when the laser lines have none or always the same; a
// pose that never changes is no odometry.
void AddOdometry(const std::vector<CarmenOdometry>& lines, const std::vector<CarmenLaser>& lasers, FieldData* data) {
  const auto moves = [&](const CarmenLaser& laser) {
    const Pose2 motion = survey::Between(*lasers.front().odom_from_body, *laser.odom_from_body);
    return motion.Translation().norm() > 0.0 || motion.theta != 0.0;
  };
  const bool stated = !lasers.empty() && lasers.front().odom_from_body;
  if (stated && std::any_of(lasers.begin(), lasers.end(), moves)) {
    for (const CarmenLaser& laser : lasers) data->odometry.push_back({laser.stamp_ns, *laser.odom_from_body});
  } else {
    for (const CarmenOdometry& line : lines) data->odometry.push_back({line.stamp_ns, line.odom_from_body});
  }
}

template <typename Sample>
void TellOfGoingBack(const std::string& what, const std::vector<Sample>& samples, FieldData* data) {
  const std::size_t back = CountGoingBack(samples);
  if (back > 0)
    data->warnings.push_back(what + ": " + std::to_string(back) + " time stamps went back; sorted by stamp");
}

}  // namespace

FieldData ReadCarmenLog(const std::filesystem::path& file, const FieldDataOptions& options) {
  CarmenMessages messages = ReadCarmenMessages(file);
  FieldData data;
  if (!messages.cut_off.empty())
    data.warnings.push_back(messages.cut_off + "; the log was cut off here, its last line is left out");

  const std::string name = ChooseMessage(file.string(), messages, options.scan_topic, &data);
  std::vector<CarmenLaser> none;
  std::vector<CarmenLaser>& lasers = name.empty() ? none : messages.lasers.at(name);
  const std::vector<StampNs> repairs = RepairClock(&lasers, &messages.odometry, &data);
  AddOdometry(messages.odometry, lasers, &data);
  if (!lasers.empty()) {
    AddMounting(messages, name, &data);
    AddScans(&lasers, repairs, options, &data);
  }
  TellOfGoingBack("scans", data.scans, &data);
  TellOfGoingBack("odometry", data.odometry, &data);
  SortScans(file.string(), &data);
  SortSamples("odometry", &data.odometry, &data);
  return data;
}

}  // namespace formats
