// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "formats/atomic_file.h"
#include "formats/control_csv.h"
#include "formats/field_csv.h"
#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace {

namespace fs = std::filesystem;

const char kRoom[] = R"(
name = "room"
crs = "EPSG:25832"
origin = [500000.0, 5600000.0]

[[wall]]
line = [[-0.1, -0.1], [12.1, -0.1], [12.1, 8.1], [-0.1, 8.1]]
thickness-m = 0.2
closed = true

[[person]]
path = [[10.0, 2.0], [10.0, 6.0]]

[survey]
stop-s = 1.0
points = [{ name = "1", at = [3.0, 2.0] }, { name = "2", at = [5.0, 2.0], role = "check" }]
features = [{ name = "sw", at = [0.0, 0.0] }]

[reference]
stations = [[6.0, 4.0]]
step-deg = 2.0
targets = [{ name = "S1", at = [8.0, 5.0, 1.0] }]

[[block]]
name = "B1"
start-s = 100
route = ["1", "2"]
)";
const char kSecondBlock[] = R"(
[[block]]
name = "B2"
start-s = 200
route = [[2.0, 5.0], [4.0, 5.0]]
)";

class Simulate : public testing::Test {
 protected:
  test_support::CommandResult Run(const std::string& scenario, const std::string& output,
                                  const std::vector<std::string>& more = {}) {
    const fs::path file = folder_ / "scenario.toml";
    std::ofstream(file) << scenario;
    std::vector<std::string> command = {"plumbline-simulate", "--scenario", file.string(), "--output",
                                        (folder_ / output).string()};
    command.insert(command.end(), more.begin(), more.end());
    return test_support::RunCommand(command);
  }
  std::map<std::string, std::string> FilesIn(const std::string& output) const {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / output)) {
      if (entry.is_regular_file())
        files[fs::relative(entry.path(), folder_ / output).string()] = formats::ReadWholeFile(entry.path());
    }
    return files;
  }

  test_support::ScratchFolder folder_;
};

TEST_F(Simulate, WritesASiteThatTheReadersUnderstand) {
  const auto result = Run(kRoom, "site", {"--picture", (folder_ / "plan.png").string()});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("block B1: 2 m"), std::string::npos) << result.err;
  EXPECT_GT(fs::file_size(folder_ / "plan.png"), 1000U);

  const fs::path block = folder_ / "site" / "blocks" / "B1";
  const formats::ScansCsv scans = formats::ReadScansCsv(block / "scans.csv");
  EXPECT_EQ(scans.geometry.num_beams, 1081);
  EXPECT_NEAR(scans.geometry.time_increment_s, 0.025 / 1440, 1e-12);
  ASSERT_GT(scans.scans.size(), 300U);
  EXPECT_EQ(scans.scans.front().stamp_ns, 100000000000);
  // From (3, 2) facing east, straight ahead is the wall 9 m away.
  EXPECT_NEAR(static_cast<double>(scans.scans.front().ranges_m[540]), 9.0, 0.1);
  EXPECT_GT(formats::ReadImuCsv(block / "imu.csv").size(), 5 * scans.scans.size() - 20);
  EXPECT_NEAR(formats::ReadOdometryCsv(block / "odometry.csv").back().odom_from_body.x, 2.0, 0.2);
  const std::vector<survey::Mark> marks = formats::ReadMarksCsv(block / "marks.csv");
  ASSERT_EQ(marks.size(), 2U);
  EXPECT_EQ(marks[1].point, "2");

  const formats::ControlCsv control =
      formats::ReadControlCsv(folder_ / "site" / "control" / "points.csv", {.crs = "EPSG:25832"});
  ASSERT_EQ(control.points.size(), 2U);
  EXPECT_EQ(control.points[1].role, survey::PointRole::kCheck);
  EXPECT_LT((control.points[0].position_in_site - Eigen::Vector2d(500003.0, 5600002.0)).norm(), 0.02);

  const auto files = FilesIn("site");
  for (const char* name : {"control/features.csv", "truth/B1.tum", "truth/points.csv", "truth/features.csv",
                           "reference/cloud.ply", "reference/targets.csv"})
    EXPECT_TRUE(files.contains(name)) << name;
  EXPECT_NE(files.at("truth/features.csv").find("sw,5600000.000000,500000.000000\n"), std::string::npos);
  EXPECT_EQ(
      static_cast<std::size_t>(std::count(files.at("truth/B1.tum").begin(), files.at("truth/B1.tum").end(), '\n')),
      scans.scans.size());
}

TEST_F(Simulate, SameBytesForAnyThreadsAndBesideAnyOtherBlock) {
  ASSERT_EQ(Run(std::string(kRoom) + kSecondBlock, "one", {"--threads", "1", "--quiet"}).status, 0);
  ASSERT_EQ(Run(std::string(kRoom) + kSecondBlock, "many", {"--threads", "4", "--quiet"}).status, 0);
  const auto one = FilesIn("one");
  EXPECT_EQ(one.size(), 4U + 4U + 2U + 2U + 4U);
  EXPECT_TRUE(one == FilesIn("many"));

  ASSERT_EQ(Run(kRoom, "alone", {"--quiet"}).status, 0);
  for (const auto& [name, content] : FilesIn("alone")) EXPECT_TRUE(content == one.at(name)) << name;

  ASSERT_EQ(Run(kRoom, "seed", {"--quiet", "--seed", "77"}).status, 0);
  const auto seed = FilesIn("seed");
  EXPECT_FALSE(seed.at("blocks/B1/scans.csv") == one.at("blocks/B1/scans.csv"));
  EXPECT_FALSE(seed.at("control/points.csv") == one.at("control/points.csv"));
  EXPECT_TRUE(seed.at("truth/points.csv") == one.at("truth/points.csv"));
}

TEST_F(Simulate, RefusesARouteThroughAWallAndLeavesNothing) {
  const auto result =
      Run(std::string(kRoom) + "\n[[block]]\nname = \"B7\"\nroute = [[3.0, 3.0], [6.0, 3.0], [6.0, 9.0]]\n", "site");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("block B7: waypoint 3 cannot be reached"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "site"));
}

TEST_F(Simulate, RefusesUnknownKeys) {
  const auto result = Run("colour = \"red\"\n" + std::string(kRoom), "site");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("scenario.toml:1: colour: unknown key"), std::string::npos) << result.err;
}

}  // namespace
