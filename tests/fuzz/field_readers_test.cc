// SPDX-License-Identifier: Apache-2.0
//
// Damaged field data: whatever the bytes, a reader gives field data that pass the checks of their kind, or a DataError
// that names the file. Seeded, so that a failure can be repeated.
#include <gtest/gtest.h>

#include <fstream>

#include "formats/errors.h"
#include "formats/field_csv.h"
#include "formats/field_data.h"
#include "survey/sensors/session_checks.h"
#include "tests/support/bag_builder.h"
#include "tests/support/random_artefacts.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using namespace test_support;

// What mutations put in: signs and words that mean something to one of the readers.
const std::vector<std::string> kPieces = {",",
                                          "\n",
                                          "\r\n",
                                          " ",
                                          "-",
                                          "1e308",
                                          "1e-999",
                                          "nan",
                                          "inf",
                                          "0",
                                          "#",
                                          "\"",
                                          ";",
                                          "FLASER",
                                          std::string(1, '\0'),
                                          "99999999999999999999",
                                          "=",
                                          ".",
                                          "\xFF",
                                          "ODOM",
                                          "-1",
                                          "t",
                                          "\t",
                                          std::string(300, '7')};

std::string Mutated(std::string bytes, RandomArtefacts* random) {
  for (std::uint64_t edits = 1 + random->Below(3); edits > 0; --edits) {
    const std::size_t at = random->Below(bytes.size() + 1);
    const std::size_t length = std::min<std::size_t>(random->Below(20), bytes.size() - at);
    switch (random->Below(5)) {
      case 0:
        bytes.insert(at, kPieces[random->Below(kPieces.size())]);
        break;
      case 1:
        bytes.replace(at, length, kPieces[random->Below(kPieces.size())]);
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(random->Below(bytes.size() + 1), 40));
        break;
      default:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random->Below(256));
    }
  }
  return random->Below(10) == 0 ? bytes.substr(0, random->Below(bytes.size() + 1)) : bytes;
}

class FieldReadersTest : public testing::Test {
 protected:
  // Reads damaged copies; counts how many were refused.
  void Run(const std::string& name, const std::string& good, int trials, std::uint64_t seed) {
    RandomArtefacts random(seed);
    int refused = 0;
    for (int trial = 0; trial < trials; ++trial) {
      SCOPED_TRACE(name + ", trial " + std::to_string(trial));
      const std::string bytes = trial == 0 ? good : Mutated(good, &random);
      refused += Refused(name, bytes) ? 1 : 0;
      ASSERT_TRUE(trial > 0 || refused == 0) << "the whole file is refused";
    }
    EXPECT_GT(refused, trials / 20);
    EXPECT_LT(refused, trials);
  }

  bool Refused(const std::string& name, const std::string& bytes) {
    const std::filesystem::path file = folder_ / name;
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    try {
      if (name == "marks.csv") {
        for (const survey::Mark& mark : ReadMarksCsv(file)) EXPECT_LT(mark.start_ns, mark.end_ns);
        return false;
      }
      const FieldData data = ReadFieldData(file, {});
      survey::Session session{.geometries = data.geometries, .scans = data.scans};
      EXPECT_TRUE(session.scans.empty() || survey::CheckSession(session).empty());
      for (const survey::ImuSample& sample : data.imu) EXPECT_TRUE(sample.specific_force_in_body.allFinite());
      for (const survey::OdometrySample& sample : data.odometry) {
        EXPECT_TRUE(sample.odom_from_body.Vector().allFinite());
      }
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
      return true;
    }
    return false;
  }

  const ScratchFolder folder_;
};

constexpr int kTrials = 400;

TEST_F(FieldReadersTest, Csv) {
  std::string scans = "# angle_min=-1 angle_increment=0.5 time_increment=0.001 range_min=0.1 range_max=30\n";
  std::string imu = "t,gx,gy,gz,ax,ay,az\n";
  std::string odometry = "t,x,y,theta\n";
  std::string marks = "point,start,end\n";
  for (int i = 0; i < 10; ++i) {
    const std::string t = std::to_string(976052857 + i) + ".5";
    scans += t + ",1.25,,3.5,0.01,29.999\n";
    imu += t + ",0.1,-0.2,0.3,0.4,-0.5,9.81\n";
    odometry += t + ",1.5,-2.5,0.1\n";
    marks += "P" + std::to_string(i) + "," + t + "," + t + "5\n";
  }
  Run("scans.csv", scans, kTrials, 31);
  Run("imu.csv", imu, kTrials, 32);
  Run("odometry.csv", odometry, kTrials, 33);
  Run("marks.csv", marks, kTrials, 34);
}

TEST_F(FieldReadersTest, CarmenLog) {
  std::string log = "# message formats\nPARAM robot_frontlaser_offset 0.1 nohost 0\n";
  for (int i = 0; i < 4; ++i) {
    const std::string t = " " + std::to_string(976052857 + i) + ".123456 nohost 0.1\n";
    log += "ODOM 1 2 0.5 0 0 0" + t;
    log += "FLASER 5 1.0 2.0 81.83 81.91 0.5 1.1 2 0.5 1 2 0.5" + t;
    log += "RAWLASER1 0 -1.57 3.14 0.0174 81.9 0.01 0 3 1 2 3 1 7" + t;
    log += "ROBOTLASER1 0 -1.57 3.14 0.0174 81.9 0.01 0 3 1 2 3 0 1.1 2 0 1 2 0 0 0 0 0 0" + t;
  }
  Run("field.log", log, kTrials, 35);
}

TEST_F(FieldReadersTest, RosBag) {
  std::string records = BagConnectionRecord(0, "/scan", "sensor_msgs/LaserScan", kLaserScanSum);
  for (std::uint32_t i = 0; i < 4; ++i) records += BagMessageRecord(0, LaserScanMessage(10 + i, {1, 2, 3}));
  Run("field.bag", BagOf(BagChunk("none", records.size(), records)), kTrials, 36);
}

}  // namespace
}  // namespace formats
