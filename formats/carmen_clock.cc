// SPDX-License-Identifier: Apache-2.0
#include "formats/carmen_clock.h"

#include <algorithm>
#include <limits>

#include "survey/sensors/clock_repair.h"
#include "survey/sensors/stamp_bursts.h"

namespace formats {
namespace {

using survey::StampNs;

template <typename Message>
std::vector<StampNs> Stamps(const std::vector<Message>& messages, StampNs Message::*stamp) {
  std::vector<StampNs> stamps;
  for (const Message& message : messages) stamps.push_back(message.*stamp);
  return stamps;
}

// Stamps in the order of the log across odometry and lasers, with the fault of old logging programs taken out.
void RepairMicroseconds(std::vector<CarmenLaser>* lasers, std::vector<CarmenOdometry>* odometry,
                        std::vector<StampNs>* laser_repairs, FieldData* data) {
  std::vector<StampNs> stamps;
  std::vector<StampNs*> targets;       // where the stamp stands
  std::vector<StampNs*> repair_notes;  // where the repair is kept; null for odometry
  std::size_t next_odometry = 0;
  const auto add_odometry_before = [&](int row) {
    for (; next_odometry < odometry->size() && (*odometry)[next_odometry].row < row; ++next_odometry) {
      targets.push_back(&(*odometry)[next_odometry].stamp_ns);
      repair_notes.push_back(nullptr);
    }
  };
  for (std::size_t i = 0; i < lasers->size(); ++i) {
    add_odometry_before((*lasers)[i].row);
    targets.push_back(&(*lasers)[i].stamp_ns);
    repair_notes.push_back(&(*laser_repairs)[i]);
  }
  add_odometry_before(std::numeric_limits<int>::max());
  for (const StampNs* target : targets) stamps.push_back(*target);

  const std::vector<StampNs> repairs = survey::RepairUnpaddedMicroseconds(stamps);
  std::size_t repaired = 0;
  for (std::size_t i = 0; i < repairs.size(); ++i) {
    *targets[i] += repairs[i];
    if (repair_notes[i] != nullptr) *repair_notes[i] = repairs[i];
    repaired += repairs[i] != 0 ? 1 : 0;
  }
  if (repaired > 0) {
    data->notes.push_back("microseconds without their leading zeros in the log: " + std::to_string(repaired) + " of " +
                          std::to_string(stamps.size()) + " stamps repaired; poses keep the printed stamps");
  }
}

// The logger's clock, set to the first stamp, where the other one stands still and it runs.
bool TakeLoggerClock(std::vector<CarmenLaser>* lasers, std::vector<CarmenOdometry>* odometry, FieldData* data) {
  constexpr double kStands = 0.05;
  constexpr double kRuns = 0.005;
  if (survey::ShareOfEqual(Stamps(*lasers, &CarmenLaser::stamp_ns)) < kStands ||
      survey::ShareOfEqual(Stamps(*lasers, &CarmenLaser::logger_ns)) > kRuns)
    return false;
  const StampNs offset = lasers->front().stamp_ns - lasers->front().logger_ns;
  for (CarmenLaser& laser : *lasers) laser.stamp_ns = laser.logger_ns + offset;
  for (CarmenOdometry& sample : *odometry) sample.stamp_ns = sample.logger_ns + offset;
  data->warnings.push_back("many laser lines have the ipc_timestamp of the line before: logger_timestamp is used");
  return true;
}

// Lines that the log holds twice.
void DropTwins(std::vector<CarmenLaser>* lasers, FieldData* data) {
  const auto same = [](const CarmenLaser& a, const CarmenLaser& b) {
    return a.stamp_ns == b.stamp_ns && a.logger_ns == b.logger_ns && a.ranges_m == b.ranges_m;
  };
  const auto end = std::unique(lasers->begin(), lasers->end(), same);
  if (end != lasers->end())
    data->notes.push_back(std::to_string(lasers->end() - end) + " laser lines that the log holds twice are taken once");
  lasers->erase(end, lasers->end());
}

// Where printed stamps are equal they are of no use to hand out poses under.
bool Spread(std::vector<CarmenLaser>* lasers, std::vector<StampNs>* laser_repairs, FieldData* data) {
  const std::vector<StampNs> stamps = Stamps(*lasers, &CarmenLaser::stamp_ns);
  const std::vector<StampNs> repairs = survey::SpreadBursts(stamps);
  if (repairs.empty()) return false;
  const bool equal = survey::ShareOfEqual(stamps) > 0.0;  // else printed stamps differ
  for (std::size_t i = 0; i < repairs.size(); ++i) {
    (*lasers)[i].stamp_ns += repairs[i];
    if (!equal) (*laser_repairs)[i] += repairs[i];
  }
  data->warnings.push_back(equal ? "many laser lines have the stamp of the line before: spread evenly"
                                 : "laser lines are stamped in bursts: spread evenly; poses keep the printed stamps");
  return true;
}

void Spread(std::vector<CarmenOdometry>* odometry) {
  const std::vector<StampNs> repairs = survey::SpreadBursts(Stamps(*odometry, &CarmenOdometry::stamp_ns));
  for (std::size_t i = 0; i < repairs.size(); ++i) (*odometry)[i].stamp_ns += repairs[i];
}

}  // namespace

std::vector<StampNs> RepairClock(std::vector<CarmenLaser>* lasers, std::vector<CarmenOdometry>* odometry,
                                 FieldData* data) {
  DropTwins(lasers, data);
  std::vector<StampNs> laser_repairs(lasers->size(), 0);
  RepairMicroseconds(lasers, odometry, &laser_repairs, data);
  if (lasers->empty() || TakeLoggerClock(lasers, odometry, data)) return laser_repairs;
  if (Spread(lasers, &laser_repairs, data)) Spread(odometry);
  return laser_repairs;
}

}  // namespace formats
