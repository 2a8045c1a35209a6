// SPDX-License-Identifier: Apache-2.0
//
// The ingest stage through its executable: what it makes of each kind of raw file, and that bad input is refused with
// file, row, value and rule while an old session stays as it was.
#include <gtest/gtest.h>

#include <cmath>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "tests/support/bag_builder.h"
#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace {

using test_support::CommandResult;

const std::string kScansHeader = "# angle_min=-1 angle_increment=0.5 time_increment=0.001 range_min=0.1 range_max=30\n";

std::string ScanRows(int from, int to) {
  std::string rows;
  for (int i = from; i < to; ++i) rows += std::to_string(100 + i) + ".5,1.5,,40,2.5,0.01\n";
  return rows;
}

std::string ImuRows() {
  std::string rows = "t,gx,gy,gz,ax,ay,az\n";
  for (int i = 0; i < 40; ++i)
    rows += std::to_string(100 + i / 4) + "." + std::to_string(i % 4 * 25) + "1,0,0,0.1,0,0,9.8" +
            std::to_string(i % 3) + "\n";
  return rows;
}

class IngestStageTest : public testing::Test {
 protected:
  IngestStageTest() {
    Write("scans.csv", kScansHeader + ScanRows(0, 10));
    Write("imu.csv", ImuRows());
    Write("odometry.csv", "t,x,y,theta\n100.1,0,0,0\n105,1,0,0.1\n110,2,0,0.2\n");
    Write("marks.csv", "point,start,end\nP1,101,103\nP2,105,107\n");
  }
  void Write(const std::string& name, const std::string& text) { formats::WriteFileAtomically(scratch_ / name, text); }
  std::string Session() { return formats::ReadWholeFile(scratch_ / "work/session.sqlite"); }
  CommandResult Run(const std::vector<std::string>& inputs) {
    std::vector<std::string> command = {"plumbline-ingest", "--output", "work/session.sqlite"};
    command.insert(command.end(), inputs.begin(), inputs.end());
    return test_support::RunCommand(command, scratch_.path().string());
  }
  CommandResult RunAll() { return Run({"--raw", "scans.csv", "imu.csv", "odometry.csv", "--marks", "marks.csv"}); }
  // Runs with one file changed; the message must hold the words, the session of before must stay.
  void ExpectRefused(const std::string& file, const std::string& text, const std::string& words) {
    ExpectRefusedRun({"--raw", "scans.csv", "imu.csv", "odometry.csv", "--marks", "marks.csv"}, words, file, text);
  }
  void ExpectRefusedRun(const std::vector<std::string>& inputs, const std::string& words, const std::string& file = "",
                        const std::string& text = "", int status = 1) {
    if (!std::filesystem::exists(scratch_ / "work/session.sqlite")) {
      ASSERT_EQ(RunAll().status, 0);
    }
    const std::string before = Session();
    std::string original;
    if (!file.empty() && std::filesystem::exists(scratch_ / file)) original = formats::ReadWholeFile(scratch_ / file);
    if (!file.empty()) Write(file, text);
    const CommandResult result = Run(inputs);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_NE(result.err.find("plumbline-ingest: " + words), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(Session(), before) << "an old output was touched";
    if (!original.empty()) Write(file, original);
  }

  test_support::ScratchFolder scratch_;
};

TEST_F(IngestStageTest, ReadsCsvFilesOfOneBlock) {
  const CommandResult result =
      Run({"--raw", "scans.csv", "imu.csv", "odometry.csv", "--marks", "marks.csv", "--lidar-x-m", "0.2",
           "--lidar-yaw-deg", "90", "--mark-dx-m", "0.05", "--range-sigma-m", "0.02", "--mark-sigma-m", "0.002"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err,
            "plumbline-ingest: 10 scans in 9.0 s (1.0 Hz), 40 IMU samples, 3 odometry samples, 2 marks, 0 warnings\n");
  const survey::Session session = formats::ReadSession(scratch_ / "work/session.sqlite");
  ASSERT_EQ(session.scans.size(), 10U);
  EXPECT_EQ(session.scans[0].stamp_ns, 100'500'000'000);
  std::vector<float> buffer;
  const std::span<const float> ranges_m = survey::RangesOf(session, 0, &buffer);
  EXPECT_EQ(ranges_m[0], 1.5F);
  EXPECT_EQ(ranges_m[1], survey::kNoReturn);
  EXPECT_EQ(ranges_m[2], survey::kNoReturn);
  EXPECT_TRUE(std::isnan(ranges_m[4]));
  EXPECT_EQ(session.imu.size(), 40U);
  EXPECT_EQ(session.odometry[1].odom_from_body.x, 1.0);
  EXPECT_EQ(session.marks[1].point, "P2");
  EXPECT_EQ(session.setup.body_from_lidar.x, 0.2);
  EXPECT_NEAR(session.setup.body_from_lidar.theta, M_PI / 2, 1e-12);
  EXPECT_EQ(session.setup.mark_in_lidar.x(), 0.05);
  EXPECT_EQ(session.setup.range_sigma_m, 0.02);
  EXPECT_EQ(session.setup.mark_sigma_m, 0.002);
}

TEST_F(IngestStageTest, SameInputsGiveTheSameBytesWhateverTheOrder) {
  ASSERT_EQ(RunAll().status, 0);
  const std::string first = Session();
  ASSERT_EQ(Run({"--raw", "odometry.csv", "imu.csv", "scans.csv", "--marks", "marks.csv", "--threads", "1"}).status, 0);
  EXPECT_EQ(Session(), first);
  Write("marks.csv", "# written by hand\npoint,start,end\nP1,101,103\n\nP2,105,107\n");
  ASSERT_EQ(RunAll().status, 0);
  EXPECT_EQ(Session(), first);
}

TEST_F(IngestStageTest, ReadsACarmenLogWithWarnings) {
  std::string log = "PARAM robot_frontlaser_offset 0.2 nohost 0\n";
  for (const char* stamp : {"5.0", "5.4", "5.2", "5.6"}) {
    log += "FLASER 3 1.0 2.0 3.0 0.2 0 0 0 0 0 " + std::string(stamp) + " nohost 0\n";
  }
  Write("field.log", log + "FLASER 3 1.0 2");
  const CommandResult result = Run({"--raw", "field.log"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("warning: scans: 1 time stamps went back; sorted by stamp"), std::string::npos);
  EXPECT_NE(result.err.find("warning: field.log:6: FLASER: wrong beam count: found 2 ranges, expected 3; the log was "
                            "cut off here, its last line is left out"),
            std::string::npos)
      << result.err;
  const survey::Session session = formats::ReadSession(scratch_ / "work/session.sqlite");
  ASSERT_EQ(session.scans.size(), 4U);
  EXPECT_EQ(session.scans[1].stamp_ns, 5'200'000'000);
  EXPECT_NEAR(session.setup.body_from_lidar.x, 0.2, 1e-12);
}

TEST_F(IngestStageTest, ReadsABagInSeveralFiles) {
  using namespace test_support;
  for (std::uint32_t part = 0; part < 2; ++part) {
    Write("part" + std::to_string(part) + ".bag",
          BagOf(BagConnectionRecord(0, "/scan", "sensor_msgs/LaserScan", kLaserScanSum) +
                BagMessageRecord(0, LaserScanMessage(10 + 2 * part, {1, 2})) +
                BagMessageRecord(0, LaserScanMessage(11 + 2 * part, {1, 2}))));
  }
  ASSERT_EQ(Run({"--raw", "part1.bag", "--raw", "part0.bag"}).status, 0);
  const survey::Session session = formats::ReadSession(scratch_ / "work/session.sqlite");
  ASSERT_EQ(session.scans.size(), 4U);
  EXPECT_EQ(session.scans[0].stamp_ns, 10'000'000'500);
  EXPECT_EQ(session.geometries.size(), 1U);
}

TEST_F(IngestStageTest, RefusesMissingAndForeignFiles) {
  ExpectRefusedRun({"--raw", "none.log"}, "none.log: no such file (--raw none.log)");
  ExpectRefusedRun({"--raw", "work"}, "work: is a folder, expected the file for --raw work");
  ExpectRefusedRun({"--raw", "notes.txt"}, "notes.txt: is not the name of raw data: *.log, *.clf (CARMEN), ",
                   "notes.txt", "hello\n");
  ExpectRefusedRun({"--raw", "marks.csv"}, "marks.csv: is not the name of raw data");
  ExpectRefusedRun({"--raw", "field.log"}, "field.log: holds no CARMEN message that is understood", "field.log",
                   "hello\n");
  ExpectRefusedRun({"--raw", "field.bag"}, "field.bag: is not a ROS bag of format 2.0", "field.bag", "hello\n");
  ExpectRefusedRun({}, "--raw is required", "", "", 2);
  ExpectRefusedRun({"--raw", "scans.csv", "--lidar-x", "1"}, "The following argument", "", "", 2);
  ExpectRefusedRun({"--raw", "scans.csv", "--range-sigma-m", "-1"}, "range-sigma-m = -1: must be between", "", "", 2);
  ExpectRefusedRun({"--raw", "scans.csv", "--range-max-m", "nan"}, "range-max-m: must be a finite number", "", "", 2);
  ExpectRefusedRun({"--raw", "scans.csv", "--config", "c.toml"}, "c.toml:1: lidar-z-m: unknown key", "c.toml",
                   "lidar-z-m = 1\n", 2);
}

TEST_F(IngestStageTest, RefusesBadScans) {
  const std::string good = kScansHeader + ScanRows(0, 10);
  ExpectRefused("scans.csv", kScansHeader + ScanRows(0, 3) + "104,1,2,3,4\n",
                "scans.csv:5: wrong beam count: found 4 ranges, expected 5 as in the first scan");
  ExpectRefused("scans.csv", good.substr(0, good.size() - 8),
                "scans.csv:11: wrong beam count: found 4 ranges, expected 5 as in the first scan (the file ends here: "
                "cut off?)");
  ExpectRefused("scans.csv", kScansHeader + "101,1,2,nan,4,5\n", "scans.csv:2: r2 = \"nan\": must be a finite number");
  ExpectRefused("scans.csv", kScansHeader + ScanRows(3, 5) + ScanRows(0, 1),
                "scans.csv:4: t = 100.5: time stamps must grow, the row before has 104.5");
  ExpectRefused("scans.csv", ScanRows(0, 3), "scans.csv:1: the first line must be # angle_min=");
  ExpectRefused("scans.csv", "# angle_mid=1\n", "scans.csv:1: angle_mid: unknown key");
  ExpectRefused("scans.csv", "", "scans.csv: is empty");
  ExpectRefused("scans.csv", kScansHeader, "scans.csv, imu.csv, odometry.csv: a log without scans");
}

TEST_F(IngestStageTest, RefusesLogsWithoutScans) {
  ExpectRefusedRun({"--raw", "odometry.csv"}, "odometry.csv: a log without scans: there is nothing to map");
  ExpectRefusedRun({"--raw", "field.log"}, "field.log: a log without scans", "field.log",
                   "ODOM 0 0 0 0 0 0 5.0 nohost 0.1\n");
}

TEST_F(IngestStageTest, RefusesBadSamples) {
  ExpectRefused("imu.csv", ImuRows() + "120,0,0\n", "imu.csv:42: 3 fields, expected 7 (t,gx,gy,gz,ax,ay,az)");
  ExpectRefused("imu.csv", ImuRows() + "120,0,0,0,NaN,0,0\n", "imu.csv:42: ax = \"NaN\": must be a finite number");
  ExpectRefused("imu.csv", ImuRows() + "101,0,0,0,0,0,0\n", "imu.csv:42: t = 101.0: time stamps must grow");
  ExpectRefused("odometry.csv", "t,x,y,theta\n1,0,0,\n", "odometry.csv:2: theta = \"\": is empty, expected a number");
  ExpectRefused("odometry.csv", "t,x,y,theta\n1,0,0,0\n",
                "scans.csv, imu.csv, odometry.csv: odometry from 1.000000 to 1.000000 s, scans from 100.500000 to "
                "109.500000 s: not on the same clock");
}

TEST_F(IngestStageTest, RefusesBadMarks) {
  const std::string header = "point,start,end\n";
  ExpectRefused("marks.csv", header + "P1,101,103\nP2,500,501\n",
                "marks.csv:3: mark on P2 from 500.000000 to 501.000000: lies outside the log, whose scans run from "
                "100.500000 to 109.500000");
  ExpectRefused("marks.csv", header + "P1,101,103\n# again\nP2,102,104\n",
                "marks.csv:4: mark on P2 from 102.000000 overlaps with the mark on P1 until 103.000000");
  ExpectRefused("marks.csv", header + "P1,103,101\n", "marks.csv:2: end = \"101\": must come after start = 103.0");
  ExpectRefused("marks.csv", header + ",101,103\n", "marks.csv:2: point = \"\": must not be empty");
  ExpectRefused("marks.csv", header + "P1,101\n", "marks.csv:2: 2 fields, expected 3 (point,start,end)");
  ExpectRefused("marks.csv", header + "P1,101.6,102.4\n",
                "marks.csv:2: mark on P1 from 101.600000 to 102.400000: holds no scan");
  ExpectRefused("marks.csv", "name,from,to\n", "marks.csv:1: header \"name,from,to\", expected point,start,end");
}

TEST_F(IngestStageTest, ABlockHasOneScanner) {
  Write("field.log", "FLASER 2 1.0 2.0 0 0 0 0 0 0 105.0 nohost 0\n");
  ExpectRefusedRun({"--raw", "scans.csv", "field.log"},
                   "field.log: its scans from 105.0 to 105.0 overlap in time with those of another file");
}

TEST_F(IngestStageTest, RefusesDamageWithinALog) {
  ExpectRefusedRun({"--raw", "field.log"}, "field.log:1: FLASER: wrong beam count: found 2 ranges, expected 3",
                   "field.log", "FLASER 3 1.0 2.0\nFLASER 2 1.0 2.0 0 0 0 0 0 0 105.0 nohost 0\n");
}

}  // namespace
