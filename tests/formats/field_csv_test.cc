// SPDX-License-Identifier: Apache-2.0
#include "formats/field_csv.h"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

constexpr const char* kHeader =
    "# angle_min=-1.5 angle_increment=0.5 time_increment=0.001 range_min=0.1 range_max=30\n";

class FieldCsvTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& content) {
    WriteFileAtomically(folder_ / name, content);
    return folder_ / name;
  }

  // The message of the DataError that reading throws, without the folder.
  template <typename Read>
  std::string Error(Read read, const std::string& content) {
    const std::filesystem::path file = Write("f.csv", content);
    try {
      read(file);
    } catch (const DataError& error) {
      const std::string message = error.what();
      const std::string prefix = folder_.path().string() + "/";
      EXPECT_TRUE(message.starts_with(prefix)) << message;
      return message.substr(prefix.size());
    }
    return "no error";
  }
  std::string ScansError(const std::string& rows, const std::string& header = kHeader) {
    return Error([](const auto& file) { return ReadScansCsv(file); }, header + rows);
  }
  std::string ImuError(const std::string& rows) { return Error(ReadImuCsv, "t,gx,gy,gz,ax,ay,az\n" + rows); }
  std::string MarksError(const std::string& rows) {
    return Error([](const auto& file) { return ReadMarksCsv(file); }, "point,start,end\n" + rows);
  }

  test_support::ScratchFolder folder_;
};

TEST_F(FieldCsvTest, ReadsScansWithBomCrlfCommentsAndBlankLines) {
  const ScansCsv read = ReadScansCsv(
      Write("scans.csv", "\xEF\xBB\xBF" + std::string(kHeader, std::string(kHeader).size() - 1) +
                             "\r\n# a remark\r\n\r\n976052858.0404137,1.5, 2 ,+3e0\r\n976052858.1,,30.5,0.05"));
  EXPECT_EQ(read.geometry.num_beams, 3);
  EXPECT_EQ(read.geometry.angle_min_rad, -1.5);
  EXPECT_EQ(read.geometry.time_increment_s, 0.001);
  ASSERT_EQ(read.scans.size(), 2U);
  EXPECT_EQ(read.scans[0].stamp_ns, 976052858040413700);
  EXPECT_EQ(read.scans[0].ranges_m, (std::vector<float>{1.5F, 2.0F, 3.0F}));
  EXPECT_EQ(read.scans[1].ranges_m[0], survey::kNoReturn);  // empty
  EXPECT_EQ(read.scans[1].ranges_m[1], survey::kNoReturn);  // beyond range_max
  EXPECT_TRUE(std::isnan(read.scans[1].ranges_m[2]));       // below range_min
}

TEST_F(FieldCsvTest, WritesWhatItReads) {
  const survey::ScanGeometry geometry{-2.1, 0.1, 1e-5, 0.0, 40.0, 4};
  const std::vector<survey::Scan> scans = {
      {.stamp_ns = -1, .ranges_m = {0.1F, 1.0F / 3, survey::kNoReturn, survey::kInvalidRange}},
      {.stamp_ns = 1'700'000'000'123'456'789, .ranges_m = {39.99F, 1e-3F, 7.0F, survey::kNoReturn}}};
  WriteScansCsv(folder_ / "scans.csv", geometry, scans);
  const ScansCsv read = ReadScansCsv(folder_ / "scans.csv");
  EXPECT_EQ(read.geometry, geometry);
  ASSERT_EQ(read.scans.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.scans[i].stamp_ns, scans[i].stamp_ns);
    for (std::size_t k = 0; k < 4; ++k) {
      if (std::isnan(scans[i].ranges_m[k])) {
        EXPECT_TRUE(std::isnan(read.scans[i].ranges_m[k]));
      } else {
        EXPECT_EQ(read.scans[i].ranges_m[k], scans[i].ranges_m[k]);
      }
    }
  }

  const std::vector<survey::ImuSample> imu = {{5, {0.1, -1e-9, 1.0 / 3}, {0, 1e5, 9.81}}};
  WriteImuCsv(folder_ / "imu.csv", imu);
  const auto imu_read = ReadImuCsv(folder_ / "imu.csv");
  ASSERT_EQ(imu_read.size(), 1U);
  EXPECT_EQ(imu_read[0].stamp_ns, 5);
  EXPECT_EQ(imu_read[0].angular_rate_in_body, imu[0].angular_rate_in_body);
  EXPECT_EQ(imu_read[0].specific_force_in_body, imu[0].specific_force_in_body);

  WriteOdometryCsv(folder_ / "odometry.csv", {{1'500'000'000, {1.25, -2.0 / 3, 3.1}}});
  const auto odometry = ReadOdometryCsv(folder_ / "odometry.csv");
  ASSERT_EQ(odometry.size(), 1U);
  EXPECT_EQ(odometry[0].stamp_ns, 1'500'000'000);
  EXPECT_EQ(odometry[0].odom_from_body.y, -2.0 / 3);

  WriteMarksCsv(folder_ / "marks.csv", {{"P 1", 1'000'000'000, 2'500'000'000}});
  std::vector<int> rows;
  const auto marks = ReadMarksCsv(folder_ / "marks.csv", &rows);
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].point, "P 1");
  EXPECT_EQ(marks[0].end_ns, 2'500'000'000);
  EXPECT_EQ(rows, std::vector<int>{2});
}

TEST_F(FieldCsvTest, RefusesBadScans) {
  EXPECT_EQ(ScansError("1,2,3\n2,2,3,4\n"),
            "f.csv:3: wrong beam count: found 3 ranges, expected 2 as in the first scan");
  EXPECT_EQ(
      ScansError("1,2,3\n2,2"),
      "f.csv:3: wrong beam count: found 1 ranges, expected 2 as in the first scan (the file ends here: cut off?)");
  EXPECT_EQ(ScansError("1,2,nan\n"),
            "f.csv:2: r1 = \"nan\": must be a finite number; leave the field empty where nothing came back");
  EXPECT_EQ(ScansError("1,2,inf\n").substr(0, 39), "f.csv:2: r1 = \"inf\": must be a finite n");
  EXPECT_EQ(ScansError("1,2,4m\n").substr(0, 35), "f.csv:2: r1 = \"4m\": is not a number");
  EXPECT_EQ(ScansError("2,2,3\n1.5,2,3\n"), "f.csv:3: t = 1.5: time stamps must grow, the row before has 2.0");
  EXPECT_EQ(ScansError("2,2,3\n2,2,3\n"), "f.csv:3: t = 2.0: time stamps must grow, the row before has 2.0");
  EXPECT_EQ(ScansError("nan,2,3\n"), "f.csv:2: t = \"nan\": must be a finite number");
  EXPECT_EQ(ScansError("1,2,3,4,5,6,7,8,9,10,11,12,13,14,15\n"),
            "f.csv:2: 14 ranges at angle_increment=0.5 rad span more than one turn");
  EXPECT_EQ(ScansError("1\n"), "f.csv:2: the row holds no scan: expected t,r0,r1,...");
}

TEST_F(FieldCsvTest, RefusesBadScanHeaders) {
  const std::string form = "# angle_min=... angle_increment=... time_increment=... range_min=... range_max=...";
  EXPECT_EQ(ScansError("", ""), "f.csv: is empty, expected " + form);
  EXPECT_EQ(ScansError("", "1,2,3\n"), "f.csv:1: the first line must be " + form);
  EXPECT_EQ(ScansError("", "# angle_min=0 angle_step=1\n"), "f.csv:1: angle_step: unknown key; expected " + form);
  EXPECT_EQ(ScansError("", "# angle_min=0 angle_min=1\n"), "f.csv:1: angle_min: given twice");
  EXPECT_EQ(ScansError("", "# angle_min=0 angle_increment=0.1 time_increment=0 range_min=0\n"),
            "f.csv:1: range_max is missing; expected " + form);
  EXPECT_EQ(ScansError("", "# angle_min=0,5\n"),
            "f.csv:1: angle_min = \"0,5\": decimal comma: write numbers with a decimal point");
  EXPECT_EQ(ScansError("", "# angle_min=-135 angle_increment=0.25 time_increment=0 range_min=0 range_max=9\n"),
            "f.csv:1: angle_min = -135: radians, must be within one turn (degrees?)");
  EXPECT_EQ(ScansError("", "# angle_min=0 angle_increment=0.25 time_increment=0 range_min=9 range_max=9\n"),
            "f.csv:1: range_max = 9: must exceed range_min");
}

TEST_F(FieldCsvTest, RefusesBadRows) {
  EXPECT_EQ(ImuError("1,0,0,0,0,0,9.8\n2,0,0,0,0,0\n"), "f.csv:3: 6 fields, expected 7 (t,gx,gy,gz,ax,ay,az)");
  EXPECT_EQ(ImuError("1,0,0,0,0,0,9,8\n"),
            "f.csv:2: 8 fields, expected 7 (t,gx,gy,gz,ax,ay,az); a decimal comma? Write numbers with a decimal point");
  EXPECT_EQ(ImuError("1;0;0;0;0;0;9\n").substr(0, 84),
            "f.csv:2: 1 fields, expected 7 (t,gx,gy,gz,ax,ay,az); separate fields by commas, not ");
  EXPECT_EQ(ImuError("1,0,NaN,0,0,0,9.8\n"), "f.csv:2: gy = \"NaN\": must be a finite number");
  EXPECT_EQ(ImuError("1,0,,0,0,0,9.8\n"), "f.csv:2: gy = \"\": is empty, expected a number");
  EXPECT_EQ(ImuError("3,0,0,0,0,0,9.8\n2,0,0,0,0,0,9.8\n"),
            "f.csv:3: t = 2.0: time stamps must grow, the row before has 3.0");
  EXPECT_EQ(Error(ReadOdometryCsv, "t,x,y\n"), "f.csv:1: header \"t,x,y\", expected t,x,y,theta");
  EXPECT_EQ(Error(ReadOdometryCsv, ""), "f.csv: is empty, expected the header t,x,y,theta");
  EXPECT_EQ(MarksError("P1,5,4\n"), "f.csv:2: end = \"4\": must come after start = 5.0");
  EXPECT_EQ(MarksError(",4,5\n"), "f.csv:2: point = \"\": must not be empty");
  EXPECT_EQ(MarksError("P1,99999999999,5\n"), "f.csv:2: start = \"99999999999\": is too large for a time stamp");
  EXPECT_EQ(Error(ReadOdometryCsv, std::string("\xFF\xFEt\0", 4)), "f.csv: is UTF-16 text; save it as UTF-8");
  EXPECT_EQ(Error(ReadOdometryCsv, std::string("t,x\0,y,theta\n", 13)),
            "f.csv:1: is not a text file (holds zero bytes)");
}

TEST_F(FieldCsvTest, NamesAMissingFile) {
  try {
    ReadImuCsv(folder_ / "none.csv");
    FAIL();
  } catch (const DataError& error) {
    EXPECT_EQ(std::string(error.what()), (folder_ / "none.csv").string() + ": no such file");
  }
}

}  // namespace
}  // namespace formats
