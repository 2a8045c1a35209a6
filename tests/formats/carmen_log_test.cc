// SPDX-License-Identifier: Apache-2.0
#include "formats/carmen_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "formats/atomic_file.h"
#include "formats/carmen_scanner.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string Flaser(const std::string& stamp, int count, const std::string& range = "2.50",
                   const std::string& poses = "1 2 0.5 1 2 0.5", const std::string& name = "FLASER") {
  std::string line = name + " " + std::to_string(count);
  for (int i = 0; i < count; ++i) line += " " + range;
  return line + " " + poses + " " + stamp + " nohost 0.1\n";
}

std::string Odom(const std::string& stamp, double x) {
  return "ODOM " + std::to_string(x) + " 0.0 0.1 0 0 0 " + stamp + " nohost 0.1\n";
}

std::string RobotLaser(const std::string& stamp, const std::string& start, int count, const std::string& range) {
  std::string line = "ROBOTLASER1 0 " + start + " 3.141593 0.017453 81.900000 0.010000 0 " + std::to_string(count);
  for (int i = 0; i < count; ++i) line += " " + range;
  return line + " 0 2.22 3 0 2 3 0 0 0 0 0 0 " + stamp + " host 0.1\n";
}

class CarmenLogTest : public testing::Test {
 protected:
  FieldData Read(const std::string& content, const FieldDataOptions& options = {}) {
    WriteFileAtomically(folder_ / "f.log", content);
    return ReadCarmenLog(folder_ / "f.log", options);
  }
  std::string Error(const std::string& content, const FieldDataOptions& options = {}) {
    try {
      Read(content, options);
    } catch (const DataError& error) {
      return std::string(error.what()).substr(folder_.path().string().size() + 1);
    }
    return "no error";
  }

  test_support::ScratchFolder folder_;
};

TEST_F(CarmenLogTest, PlacesBeamsByTheirNumber) {
  struct Case {
    int beams;
    double first_deg, step_deg;
  };
  for (const Case& c : {Case{180, -90, 1},
                        {181, -90, 1},
                        {360, -90, 0.5},
                        {361, -90, 0.5},
                        {401, -50, 0.25},
                        {100, -50, 1},
                        {721, -90, 0.25}}) {
    const FieldData data = Read(Flaser("5.0", c.beams));
    ASSERT_EQ(data.geometries.size(), 1U);
    EXPECT_EQ(data.geometries[0].num_beams, c.beams);
    EXPECT_NEAR(data.geometries[0].angle_min_rad / kDegree, c.first_deg, 1e-12);
    EXPECT_NEAR(data.geometries[0].angle_increment_rad / kDegree, c.step_deg, 1e-12);
    EXPECT_TRUE(data.warnings.empty());
  }
  const FieldData odd = Read(Flaser("5.0", 91));
  EXPECT_NEAR(odd.geometries[0].angle_increment_rad / kDegree, 2, 1e-12);
  ASSERT_EQ(odd.warnings.size(), 1U);
  EXPECT_EQ(odd.warnings[0], "scans of no known scanner: their beams are taken to span 180 degrees");
}

TEST_F(CarmenLogTest, BeamCountMayChangeFromScanToScan) {
  const FieldData data = Read(RobotLaser("5.0", "-1.570796", 181, "2") + RobotLaser("5.2", "-1.566433", 180, "2") +
                              RobotLaser("5.4", "-1.570796", 181, "2"));
  ASSERT_EQ(data.geometries.size(), 2U);
  EXPECT_EQ(data.geometries[1].angle_min_rad, -1.566433);
  EXPECT_NEAR(data.geometries[1].angle_increment_rad, kDegree, 1e-15);
  ASSERT_EQ(data.scans.size(), 3U);
  EXPECT_EQ(data.scans[0].geometry, 0);
  EXPECT_EQ(data.scans[1].geometry, 1);
  EXPECT_EQ(data.scans[2].geometry, 0);
  EXPECT_EQ(data.scans[1].ranges_m.size(), 180U);
}

TEST_F(CarmenLogTest, UsesTheIpcStampAndThePosesOfTheBody) {
  const FieldData data =
      Read("PARAM robot_frontlaser_offset 0.30 nohost 0\n" + Flaser("976052857.541", 180, "1", "1.3 2 0 1 2 0") +
           Flaser("976052858.5", 180, "1", "1 2.3 1.570796 1 2 1.570796"));
  EXPECT_EQ(data.scans[0].stamp_ns, 976052857541000000);
  EXPECT_EQ(data.scans[0].clock_repair_ns, 0);
  ASSERT_EQ(data.odometry.size(), 2U);
  EXPECT_EQ(data.odometry[0].stamp_ns, 976052857541000000);
  EXPECT_EQ(data.odometry[0].odom_from_body.x, 1.0);
  ASSERT_TRUE(data.body_from_lidar.has_value());
  EXPECT_NEAR(data.body_from_lidar->x, 0.3, 1e-9);
  EXPECT_NEAR(data.body_from_lidar->y, 0.0, 1e-9);
  EXPECT_NEAR(data.body_from_lidar->theta, 0.0, 1e-9);
}

TEST_F(CarmenLogTest, OdomLinesStandInForEmbeddedPosesThatNeverChange) {
  const FieldData data = Read(Odom("4.9", 7) + Flaser("5.0", 180) + Odom("5.1", 8) + Flaser("5.2", 180));
  ASSERT_EQ(data.odometry.size(), 2U);
  EXPECT_EQ(data.odometry[1].odom_from_body.x, 8.0);
  EXPECT_EQ(data.odometry[1].stamp_ns, 5'100'000'000);
}

TEST_F(CarmenLogTest, EmbeddedPosesThatMoveComeBeforeOdomLines) {
  const FieldData data =
      Read(Odom("4.9", 7) + Flaser("5.0", 180) + Odom("5.1", 8) + Flaser("5.2", 180, "1", "3 2 0.5 3 2 0.5"));
  ASSERT_EQ(data.odometry.size(), 2U);
  EXPECT_EQ(data.odometry[1].odom_from_body.x, 3.0);
  EXPECT_EQ(data.odometry[1].stamp_ns, 5'200'000'000);
}

TEST_F(CarmenLogTest, APoseThatNeverChangesIsNoOdometry) {
  EXPECT_TRUE(Read(Flaser("5.0", 180) + Flaser("5.2", 180) + Flaser("5.4", 180)).odometry.empty());
  const std::string moved = Flaser("5.6", 180, "1", "1.1 2 0.5 1.1 2 0.5");
  EXPECT_EQ(Read(Flaser("5.0", 180) + Flaser("5.2", 180) + moved).odometry.size(), 3U);
}

TEST_F(CarmenLogTest, CorrectedLogsDoNotMoveTheLaser) {
  const FieldData data = Read("PARAM robot_frontlaser_offset 0.25 nohost 0\n" + Flaser("5.0", 180, "1", "1 2 0 1 2 0") +
                              Flaser("6.0", 180, "1", "1.5 2 0 1 2 0"));
  EXPECT_NEAR(data.body_from_lidar->x, 0.25, 1e-9);
  ASSERT_EQ(data.warnings.size(), 1U);
  EXPECT_NE(data.warnings[0].find("corrected poses"), std::string::npos);
}

TEST_F(CarmenLogTest, RawLaserTakesItsPlaceFromTheParams) {
  std::string raw = "RAWLASER1 0 -1.570796 3.141593 0.008727 8.1 0.01 0 3 1.0 8.1 9.5 2 10 20 7.5 host 0.1\n";
  const FieldData data =
      Read("PARAM robot_frontlaser_offset 0.1 h 0\nPARAM robot_frontlaser_angular_offset 0.02 h 0\n" + raw);
  ASSERT_EQ(data.scans.size(), 1U);
  EXPECT_EQ(data.scans[0].ranges_m, (std::vector<float>{1.0F, survey::kNoReturn, survey::kNoReturn}));
  EXPECT_NEAR(data.geometries[0].angle_increment_rad / kDegree, 0.5, 1e-12);
  EXPECT_EQ(data.geometries[0].range_max_m, 8.1);
  EXPECT_EQ(data.body_from_lidar->x, 0.1);
  EXPECT_EQ(data.body_from_lidar->theta, 0.02);
  EXPECT_TRUE(data.odometry.empty());
}

TEST_F(CarmenLogTest, RearLaserOnlyWhenAlone) {
  const std::string rear = Flaser("5.1", 180, "3", "-0.2 2 3.141593 0 2 0", "RLASER");
  const FieldData both = Read(Flaser("5.0", 180) + rear);
  EXPECT_EQ(both.scans.size(), 1U);
  ASSERT_EQ(both.notes.size(), 1U);
  EXPECT_EQ(both.notes[0], "1 RLASER scans are not used, but FLASER; scan-topic chooses");
  const FieldData chosen = Read(Flaser("5.0", 180) + rear, {.scan_topic = "RLASER"});
  ASSERT_EQ(chosen.scans.size(), 1U);
  EXPECT_EQ(chosen.scans[0].stamp_ns, 5'100'000'000);
  EXPECT_NEAR(chosen.body_from_lidar->x, -0.2, 1e-9);
  EXPECT_NEAR(std::abs(chosen.body_from_lidar->theta), std::numbers::pi, 1e-5);
  EXPECT_EQ(Read(rear).scans.size(), 1U);
  EXPECT_EQ(Error(rear, {.scan_topic = "FLASER"}), "f.log: holds no laser message FLASER; it has RLASER");
}

TEST(CarmenScannerTest, SickCodesAreNoDistances) {
  std::vector<float> ranges = {81.82F, 81.83F, 81.91F, 81.87F, 0.0F, 12.0F};
  const CarmenRangeLimits limits = LimitsFromReadings({&ranges});
  EXPECT_EQ(limits.sick_codes, SickUnit::kCentimetre);
  EXPECT_EQ(limits.max_m, 81.83);
  ClassifyRanges(limits, &ranges);
  EXPECT_EQ(ranges[0], 81.82F);
  EXPECT_EQ(ranges[1], survey::kNoReturn);
  EXPECT_TRUE(std::isnan(ranges[2]));
  EXPECT_TRUE(std::isnan(ranges[3]));
  EXPECT_TRUE(std::isnan(ranges[4]));
  EXPECT_EQ(ranges[5], 12.0F);
}

// In millimetres, printed as such or as centimetres.
TEST(CarmenScannerTest, SickCodesOfMillimetresAreNoDistances) {
  for (const auto& [beyond, none] : {std::pair(8.183F, 8.191F), std::pair(8.18F, 8.19F)}) {
    std::vector<float> ranges(30, beyond);
    ranges.insert(ranges.end(), {none, 8.0F, 0.0F, 3.0F});
    const CarmenRangeLimits limits = LimitsFromReadings({&ranges});
    EXPECT_EQ(limits.sick_codes, SickUnit::kMillimetre);
    ClassifyRanges(limits, &ranges);
    EXPECT_EQ(ranges[0], survey::kNoReturn);
    EXPECT_TRUE(std::isnan(ranges[30]));
    EXPECT_EQ(ranges[31], 8.0F);
    EXPECT_TRUE(std::isnan(ranges[32]));
    EXPECT_EQ(ranges[33], 3.0F);
  }
  std::vector<float> walls;
  for (int i = 0; i < 400; ++i) walls.push_back(0.02F * static_cast<float>(i));
  walls.push_back(8.191F);  // a wall as any other
  EXPECT_EQ(LimitsFromReadings({&walls}).sick_codes, SickUnit::kNone);
}

TEST(CarmenScannerTest, AClippedLogRepeatsItsLargestValue) {
  std::vector<float> ranges(1000, 50.0F);
  ranges[1] = 49.8F;
  ranges[2] = 3.0F;
  const CarmenRangeLimits limits = LimitsFromReadings({&ranges});
  EXPECT_EQ(limits.max_m, 50.0);
  EXPECT_TRUE(limits.max_means_no_return);
  ClassifyRanges(limits, &ranges);
  EXPECT_EQ(ranges[0], survey::kNoReturn);
  EXPECT_EQ(ranges[1], 49.8F);
}

TEST(CarmenScannerTest, AnUnclippedLogHasNoLimit) {
  std::vector<float> ranges;
  for (int i = 1; i < 2000; ++i) ranges.push_back(0.01F * static_cast<float>(i));
  const CarmenRangeLimits limits = LimitsFromReadings({&ranges});
  EXPECT_FALSE(limits.max_means_no_return);
  const std::vector<float> before = ranges;
  ClassifyRanges(limits, &ranges);
  EXPECT_EQ(ranges, before);
}

TEST_F(CarmenLogTest, RangeLimitsCanBeGiven) {
  const FieldData data = Read(Flaser("5.0", 180, "2.5"), {.range_min_m = 0.1, .range_max_m = 2.5});
  EXPECT_EQ(data.scans[0].ranges_m[0], survey::kNoReturn);
  EXPECT_EQ(data.geometries[0].range_min_m, 0.1);
  EXPECT_EQ(data.geometries[0].range_max_m, 2.5);
}

TEST_F(CarmenLogTest, StampsOutOfOrderAreSortedAndDuplicatesDropped) {
  const FieldData data = Read(Flaser("5.5", 180, "1") + Flaser("5.25", 180, "2") + Flaser("5.5", 180, "3"));
  ASSERT_EQ(data.scans.size(), 2U);
  EXPECT_EQ(data.scans[0].ranges_m[0], 2.0F);
  EXPECT_EQ(data.scans[1].ranges_m[0], 1.0F);
  ASSERT_FALSE(data.warnings.empty());
  EXPECT_EQ(data.warnings[0], "scans: 1 time stamps went back; sorted by stamp");
  EXPECT_EQ(data.warnings.at(1), "scans: 1 dropped with the stamp of the one before");
}

TEST_F(CarmenLogTest, AnUnpaddedClockIsRepairedAndPrintedStampsKept) {
  std::string log;
  std::vector<survey::StampNs> truth;
  for (int i = 0; i < 600; ++i) {
    const long long us = 1'000'000'000LL + i * 61'537LL;
    truth.push_back(us * 1000);
    std::string fraction = std::to_string(us % 1'000'000);
    fraction.resize(6, '0');
    const std::string pose = std::to_string(i) + " 2 0.5";
    log += Flaser(std::to_string(us / 1'000'000) + "." + fraction, 180, std::to_string(1000 + i) + "e-3",
                  pose + " " + pose);
  }
  const FieldData data = Read(log);
  ASSERT_EQ(data.scans.size(), truth.size());
  ASSERT_EQ(data.odometry.size(), truth.size());
  int repaired = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(data.scans[i].stamp_ns, truth[i]);
    EXPECT_FLOAT_EQ(data.scans[i].ranges_m[0], 1.0F + 0.001F * static_cast<float>(i));
    EXPECT_EQ(data.odometry[i].stamp_ns, truth[i]);
    repaired += data.scans[i].clock_repair_ns != 0 ? 1 : 0;
  }
  EXPECT_GT(repaired, 40);
  EXPECT_TRUE(data.warnings.empty());
}

// Laser lines 0.2 s apart with these stamps; `logger` counts on its own where it is given.
std::string Stamped(const std::vector<double>& stamps, double logger_step) {
  std::string log;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const std::string pose = std::to_string(i) + " 2 0.5";
    std::string line = Flaser(std::to_string(stamps[i]), 180, std::to_string(1000 + i) + "e-3", pose + " " + pose);
    line.replace(line.rfind("0.1"), 3, std::to_string(logger_step * static_cast<double>(i)));
    log += line;
  }
  return log;
}

void ExpectEverySpan(const std::vector<survey::Scan>& scans, double seconds) {
  for (std::size_t i = 1; i < scans.size(); ++i) {
    EXPECT_NEAR(survey::Seconds(scans[i].stamp_ns - scans[i - 1].stamp_ns), seconds, 1e-6) << i;
    EXPECT_FLOAT_EQ(scans[i].ranges_m[0], 1.0F + 0.001F * static_cast<float>(i));
  }
}

TEST_F(CarmenLogTest, StampsOfWholeSecondsAreSpreadAndThoseOfBurstsToo) {
  std::vector<double> whole_seconds;
  std::vector<double> bursts;
  for (int i = 0; i < 100; ++i) {
    whole_seconds.push_back(976052857.0 + std::floor(0.2 * i + 1e-9));
    bursts.push_back(100.0 + 0.2 * (i / 10 * 10 + 9) + 0.001 * (i % 10));
  }
  const FieldData whole = Read(Stamped(whole_seconds, 0.0));
  ASSERT_EQ(whole.scans.size(), 100U);
  ExpectEverySpan(whole.scans, 0.2);
  EXPECT_EQ(whole.odometry.size(), 100U);
  EXPECT_EQ(whole.scans[3].clock_repair_ns, 0);
  ASSERT_EQ(whole.warnings.size(), 1U);
  EXPECT_EQ(whole.warnings[0], "many laser lines have the stamp of the line before: spread evenly");

  const FieldData burst = Read(Stamped(bursts, 0.2));
  ExpectEverySpan(burst.scans, 0.2);
  EXPECT_EQ(burst.scans[9].clock_repair_ns, 0);
  EXPECT_NEAR(survey::Seconds(burst.scans[0].clock_repair_ns), -1.8 + 0.009, 1e-6);
  EXPECT_NE(burst.warnings.at(0).find("in bursts"), std::string::npos);
}

TEST_F(CarmenLogTest, AClockThatStandsIsReplacedByTheLoggersOrRefused) {
  const std::vector<double> standing(100, 976052857.0);
  const FieldData data = Read(Stamped(standing, 0.2));
  ExpectEverySpan(data.scans, 0.2);
  EXPECT_EQ(data.scans[0].stamp_ns, 976052857'000'000'000);
  EXPECT_NE(data.warnings.at(0).find("logger_timestamp is used"), std::string::npos);
  EXPECT_EQ(
      Error(Stamped(standing, 0.0)),
      "f.log: 99 of 100 scans have the time stamp of another: the clock of the log stands still or is too coarse");
}

TEST_F(CarmenLogTest, ACutOffLastLineIsAWarning) {
  const std::string whole = Flaser("5.0", 180);
  const FieldData data = Read(whole + Flaser("5.2", 180).substr(0, 200));
  EXPECT_EQ(data.scans.size(), 1U);
  ASSERT_EQ(data.warnings.size(), 1U);
  EXPECT_NE(data.warnings[0].find("f.log:2: FLASER: wrong beam count: found 38 ranges, expected 180; the log was cut"),
            std::string::npos)
      << data.warnings[0];
}

TEST_F(CarmenLogTest, RefusesMalformedMessages) {
  const std::string whole = Flaser("5.0", 180);
  EXPECT_EQ(Error(whole.substr(0, 100) + "\n" + whole),
            "f.log:1: FLASER: wrong beam count: found 18 ranges, expected 180");
  EXPECT_EQ(Error("FLASER 2 1.0 2.0 3.0 0 0 0 0 0 0 5.0 nohost 0.1\n"),
            "f.log:1: FLASER: logger_timestamp = \"nohost\": is not a number");
  EXPECT_EQ(Error("FLASER 3 1.0 2.0 0 0 0 0 0 0 5.0 nohost 0.1\n"),
            "f.log:1: FLASER: ipc_timestamp = \"nohost\": is not a number (more ranges than the count says?)");
  EXPECT_EQ(Error("FLASER 2 1.0 nan 0 0 0 0 0 0 5.0 nohost 0.1\n"),
            "f.log:1: FLASER: ranges 1 = \"nan\": must be a finite number");
  EXPECT_EQ(Error("FLASER -1 1.0\n"),
            "f.log:1: FLASER: num_readings = \"-1\": must be a whole number from 0 to 100000");
  EXPECT_EQ(Error("FLASER 99999999999999999999 1.0\n").substr(0, 32), "f.log:1: FLASER: num_readings = ");
  EXPECT_EQ(Error("ODOM 0 0 x 0 0 0 5.0 nohost 0.1\n"), "f.log:1: ODOM: x y theta = \"x\": is not a number");
  EXPECT_EQ(Error("ODOM 0 0 0 0 0 0\n"), "f.log:1: ODOM: ends before ipc_timestamp");
  EXPECT_EQ(Error("RAWLASER1 0 -1.5 3.1 0 8.1 0.01 0 1 1.0 0 7.5 host 0.1\n"),
            "f.log:1: RAWLASER1: angular_resolution = 0: must not be 0");
  EXPECT_EQ(Error("t,x,y\n1,2,3\n").substr(0, 54), "f.log: holds no CARMEN message that is understood (FLA");
  EXPECT_EQ(Error("").substr(0, 28), "f.log: holds no CARMEN messa");
}

}  // namespace
}  // namespace formats
