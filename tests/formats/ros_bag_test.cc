// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_bag.h"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>

#include <cmath>
#include <limits>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/bag_builder.h"
#include "tests/support/real_data.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using namespace test_support;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string OneScan(const std::string& topic = "/scan", std::uint32_t id = 0, std::uint32_t seconds = 10) {
  return BagConnectionRecord(id, topic, "sensor_msgs/LaserScan", kLaserScanSum) +
         BagMessageRecord(id, LaserScanMessage(seconds, {1.0F, kInf, 31.0F, kNan, -kInf, 0.1F}));
}

class RosBagTest : public testing::Test {
 protected:
  FieldData Read(const std::string& bytes, const FieldDataOptions& options = {}) {
    WriteFileAtomically(folder_ / "f.bag", bytes);
    return ReadRosBag(folder_ / "f.bag", options);
  }
  std::string Error(const std::string& bytes, const FieldDataOptions& options = {}) {
    try {
      Read(bytes, options);
    } catch (const DataError& error) {
      return std::string(error.what()).substr(folder_.path().string().size() + 1);
    }
    return "no error";
  }
  void ExpectOneScan(const FieldData& data) {
    ASSERT_EQ(data.scans.size(), 1U);
    ASSERT_EQ(data.geometries.size(), 1U);
    EXPECT_EQ(data.geometries[0].num_beams, 6);
    EXPECT_EQ(data.geometries[0].angle_min_rad, -1.0);
    EXPECT_EQ(data.geometries[0].angle_increment_rad, 0.5);
    EXPECT_EQ(data.scans[0].stamp_ns, 10'000'000'500);
    const std::vector<float>& ranges = data.scans[0].ranges_m;
    EXPECT_EQ(ranges[0], 1.0F);
    EXPECT_EQ(ranges[1], survey::kNoReturn);
    EXPECT_EQ(ranges[2], survey::kNoReturn);
    EXPECT_TRUE(std::isnan(ranges[3]));
    EXPECT_TRUE(std::isnan(ranges[4]));
    EXPECT_TRUE(std::isnan(ranges[5]));
  }

  test_support::ScratchFolder folder_;
};

TEST_F(RosBagTest, ReadsScansWhateverTheCompression) {
  const std::string records = OneScan();
  ExpectOneScan(Read(BagOf(records)));
  ExpectOneScan(Read(BagOf(BagChunk("none", records.size(), records))));

  std::string bz2(records.size() + 1000, '\0');
  auto bz2_size = static_cast<unsigned int>(bz2.size());
  std::string source = records;
  ASSERT_EQ(
      BZ2_bzBuffToBuffCompress(bz2.data(), &bz2_size, source.data(), static_cast<unsigned int>(source.size()), 9, 0, 0),
      BZ_OK);
  bz2.resize(bz2_size);
  ExpectOneScan(Read(BagOf(BagChunk("bz2", records.size(), bz2))));
  EXPECT_EQ(Error(BagOf(BagChunk("bz2", records.size(), bz2.substr(10)))),
            "f.bag: a chunk cannot be decompressed (bzip2)");

  std::string lz4(LZ4F_compressFrameBound(records.size(), nullptr), '\0');
  lz4.resize(LZ4F_compressFrame(lz4.data(), lz4.size(), records.data(), records.size(), nullptr));
  ExpectOneScan(Read(BagOf(BagChunk("lz4", records.size(), lz4))));
  EXPECT_EQ(Error(BagOf(BagChunk("lz4", records.size() - 1, lz4))), "f.bag: a chunk cannot be decompressed (LZ4)");
}

TEST_F(RosBagTest, TakesTheFirstEcho) {
  std::string message = RosHeader(3, 0);
  for (const float value : {-1.0F, 1.0F, 0.5F, 0.001F, 0.1F, 0.2F, 30.0F}) message += Bytes(value);
  message += Bytes(std::uint32_t{3});
  message += Bytes(std::uint32_t{2}) + Bytes(4.0F) + Bytes(5.0F);
  message += Bytes(std::uint32_t{0});
  message += Bytes(std::uint32_t{1}) + Bytes(6.0F);
  message += Bytes(std::uint32_t{0});
  const FieldData data = Read(BagOf(BagConnectionRecord(0, "/echo", "sensor_msgs/MultiEchoLaserScan", kMultiEchoSum) +
                                    BagMessageRecord(0, message)));
  ASSERT_EQ(data.scans.size(), 1U);
  EXPECT_EQ(data.scans[0].ranges_m, (std::vector<float>{4.0F, survey::kNoReturn, 6.0F}));
}

TEST_F(RosBagTest, ReadsImuAndOdometry) {
  std::string imu = RosHeader(4, 1);
  const auto add = [&imu](int count, double first) {
    for (int i = 0; i < count; ++i) imu += Bytes(first + i);
  };
  add(4, 0);
  add(9, 0);
  add(3, 10);
  add(9, 0);
  add(3, 20);
  add(9, 0);
  std::string odometry = RosHeader(5, 0) + Sized("base_link");
  for (const double value : {1.0, 2.0, 3.0, 0.0, 0.0, std::sin(0.4), std::cos(0.4)}) odometry += Bytes(value);
  odometry += std::string(36 * 8 + 6 * 8 + 36 * 8, '\0');
  const FieldData data =
      Read(BagOf(OneScan() + BagConnectionRecord(1, "/imu", "sensor_msgs/Imu", kImuSum) + BagMessageRecord(1, imu) +
                 BagConnectionRecord(2, "/odom", "nav_msgs/Odometry", kOdometrySum) + BagMessageRecord(2, odometry) +
                 BagMessageRecord(2, odometry)));
  ASSERT_EQ(data.imu.size(), 1U);
  EXPECT_EQ(data.imu[0].stamp_ns, 4'000'000'001);
  EXPECT_EQ(data.imu[0].angular_rate_in_body, Eigen::Vector3d(10, 11, 12));
  EXPECT_EQ(data.imu[0].specific_force_in_body, Eigen::Vector3d(20, 21, 22));
  ASSERT_EQ(data.odometry.size(), 1U);
  EXPECT_EQ(data.odometry[0].odom_from_body.x, 1.0);
  EXPECT_NEAR(data.odometry[0].odom_from_body.theta, 0.8, 1e-12);
  EXPECT_EQ(data.warnings, std::vector<std::string>{"odometry: 1 dropped with the stamp of the one before"});
}

TEST_F(RosBagTest, SeveralTopicsNeedAChoice) {
  const std::string bag = BagOf(OneScan("/front", 0) + OneScan("/rear", 1, 12));
  EXPECT_EQ(Error(bag), "f.bag: several topics could be the scan: /front, /rear; choose one with scan-topic");
  EXPECT_EQ(Read(bag, {.scan_topic = "/rear"}).scans[0].stamp_ns, 12'000'000'500);
  EXPECT_EQ(Error(bag, {.scan_topic = "/side"}), "f.bag: scan-topic /side: no such topic; the bag has /front, /rear");
}

TEST_F(RosBagTest, ARecordingThatWasNotClosedGivesWhatItHas) {
  const std::string open = BagOf(OneScan() + BagMessageRecord(0, LaserScanMessage(11, {1.0F, 2.0F})), false);
  const FieldData data = Read(open.substr(0, open.size() - 5));
  EXPECT_EQ(data.scans.size(), 1U);
  ASSERT_EQ(data.warnings.size(), 1U);
  EXPECT_NE(data.warnings[0].find("the recording was not closed"), std::string::npos);
  const std::string closed = BagOf(OneScan());
  EXPECT_EQ(Error(closed.substr(0, closed.size() - 5)), "f.bag: is truncated: it ends within a record");
}

TEST_F(RosBagTest, RefusesWhatIsNoBag) {
  EXPECT_EQ(Error(""), "f.bag: is not a ROS bag of format 2.0");
  EXPECT_EQ(Error("#ROSBAG V1.2\nabc"), "f.bag: is not a ROS bag of format 2.0");
  EXPECT_EQ(Error(BagOf(BagMessageRecord(0, "x"))), "f.bag: a message of a connection that is not described");
  EXPECT_EQ(Error(BagOf(BagConnectionRecord(0, "/scan", "sensor_msgs/LaserScan", kLaserScanSum) +
                        BagMessageRecord(0, LaserScanMessage(1, {1.0F})))),
            "f.bag: /scan message 1: wrong beam count: 1");
  EXPECT_EQ(Error(BagOf(BagConnectionRecord(0, "/scan", "sensor_msgs/LaserScan", "0123") + BagMessageRecord(0, "x"))),
            "f.bag: /scan message 1: another version of its type (sensor_msgs/LaserScan 0123)");
  EXPECT_EQ(
      Error(BagOf(BagConnectionRecord(0, "/imu", "sensor_msgs/Imu", kImuSum) + BagMessageRecord(0, RosHeader(1, 1)))),
      "f.bag: /imu message 1: data ends early");
}

TEST(RosBagRealDataTest, ReadsRecordingsOfOthers) {
  const auto scans = RealData("bags/scan_tools_demo.bag");  // the lengths of its index records are wrong
  const auto husky = RealData("bags/test1_husky_imu_odom_gps.bag");
  if (!scans || !husky) GTEST_SKIP() << "no real data";
  const FieldData demo = ReadRosBag(*scans, {});
  EXPECT_EQ(demo.scans.size(), 360U);
  EXPECT_EQ(demo.geometries.at(0).num_beams, 681);
  EXPECT_NEAR(survey::Seconds(demo.scans.back().stamp_ns - demo.scans.front().stamp_ns), 35.8, 0.1);
  const FieldData drive = ReadRosBag(*husky, {});
  EXPECT_EQ(drive.imu.size(), 11865U);
  EXPECT_EQ(drive.odometry.size(), 3952U);
  EXPECT_TRUE(drive.scans.empty());
}

}  // namespace
}  // namespace formats
