// SPDX-License-Identifier: Apache-2.0
//
// Four well-known logs, counted by others (see the data's notes): scans, beams, duration, odometry path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "formats/atomic_file.h"
#include "formats/carmen_log.h"
#include "formats/line_reader.h"
#include "formats/text_numbers.h"
#include "tests/support/command.h"
#include "tests/support/real_data.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

struct Expected {
  const char* file;
  std::size_t scans;
  std::size_t geometries;
  int beams;  // of the first geometry
  double range_max_m;
  double duration_s;
  double path_m;
  double lidar_x_m;
};

double PathLength(const std::vector<survey::OdometrySample>& odometry) {
  double length = 0.0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    length += (odometry[i].odom_from_body.Translation() - odometry[i - 1].odom_from_body.Translation()).norm();
  }
  return length;
}

class RealLogTest : public testing::TestWithParam<Expected> {};

TEST_P(RealLogTest, HoldsWhatOthersCounted) {
  const Expected& expected = GetParam();
  const auto packed = test_support::RealData("radish/" + std::string(expected.file) + ".bz2");
  if (!packed) GTEST_SKIP() << "no real data";
  const test_support::CommandResult unpacked = test_support::RunCommand({"bunzip2", "-k", "-c", packed->string()});
  if (unpacked.status != 0) GTEST_SKIP() << "no bunzip2";
  const test_support::ScratchFolder folder;
  WriteFileAtomically(folder / expected.file, unpacked.out);

  const FieldData data = ReadCarmenLog(folder / expected.file, {});
  EXPECT_EQ(data.scans.size(), expected.scans);
  ASSERT_EQ(data.geometries.size(), expected.geometries);
  EXPECT_EQ(data.geometries[0].num_beams, expected.beams);
  EXPECT_NEAR(data.geometries[0].angle_min_rad, -M_PI / 2, 1e-6);
  EXPECT_EQ(data.geometries[0].range_max_m, expected.range_max_m);
  EXPECT_NEAR(survey::Seconds(data.scans.back().stamp_ns - data.scans.front().stamp_ns), expected.duration_s, 1.0);
  // Were the stamps of the Intel log not repaired, sorting by them would make 675 m of its 508 m.
  EXPECT_NEAR(PathLength(data.odometry), expected.path_m, 2.0);
  ASSERT_TRUE(data.body_from_lidar.has_value());
  EXPECT_NEAR(data.body_from_lidar->x, expected.lidar_x_m, 1e-9);
  EXPECT_NEAR(data.body_from_lidar->y, 0.0, 1e-9);
  for (std::size_t i = 1; i < data.scans.size(); ++i) ASSERT_GT(data.scans[i].stamp_ns, data.scans[i - 1].stamp_ns);
}

INSTANTIATE_TEST_SUITE_P(Radish, RealLogTest,
                         testing::Values(Expected{"intel.clf", 13631, 1, 180, 81.83, 2691, 508, 0.0},
                                         Expected{"aces.clf", 7374, 1, 180, 50.0, 1366, 325, 0.0},
                                         Expected{"mit-csail.clf", 1988, 1, 361, 81.83, 424, 374, 0.0},
                                         Expected{"fr-clinic_robotlaser.clf", 6917, 4, 181, 81.9, 4820, 1402, 0.22}),
                         [](const auto& info) {
                           std::string name;
                           for (const char c : std::string(info.param.file)) name += std::isalnum(c) != 0 ? c : '_';
                           return name;
                         });

// The relations between scans name them by the stamps that the log prints.
TEST(RealLogRelationsTest, EveryRelationFindsItsScans) {
  const auto relations = test_support::RealData("radish/intel.relations");
  const auto packed = test_support::RealData("radish/intel.clf.bz2");
  if (!relations || !packed) GTEST_SKIP() << "no real data";
  const test_support::CommandResult unpacked = test_support::RunCommand({"bunzip2", "-k", "-c", packed->string()});
  if (unpacked.status != 0) GTEST_SKIP() << "no bunzip2";
  const test_support::ScratchFolder folder;
  WriteFileAtomically(folder / "intel.clf", unpacked.out);
  survey::Session session;
  session.scans = ReadCarmenLog(folder / "intel.clf", {}).scans;
  std::vector<survey::StampNs> recorded;
  for (const survey::ScanStamp& stamp : survey::StampsOfScans(session)) recorded.push_back(stamp.recorded_ns);
  std::sort(recorded.begin(), recorded.end());

  LineReader lines(*relations);
  std::string_view line;
  int count = 0;
  while (lines.Next(&line)) {
    const std::size_t space = line.find(' ');
    for (const std::string_view text :
         {line.substr(0, space), line.substr(space + 1, line.find(' ', space + 1) - space - 1)}) {
      const auto stamp = ParseStamp(text);
      ASSERT_TRUE(stamp.has_value()) << text;
      EXPECT_TRUE(std::binary_search(recorded.begin(), recorded.end(), *stamp)) << text;
    }
    ++count;
  }
  EXPECT_EQ(count, 2984);
}

}  // namespace
}  // namespace formats
