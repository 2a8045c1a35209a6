// SPDX-License-Identifier: Apache-2.0
#include "formats/scenario_toml.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "formats/errors.h"
#include "survey/simulation/floor_plan.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

const char kRoom[] = R"(
name = "room"
crs = "EPSG:25832"
origin = [500000.0, 5600000.0]
seed = 9

[lidar]
near-sigma-m = 0.02

[imu]
gyro-bias-deg-h = 180
accelerometer-bias-mgal = 1000

[cart]
body-from-lidar = [0.1, 0.2, 90]

[[wall]]
line = [[-0.1, -0.1], [20.1, -0.1], [20.1, 10.1], [-0.1, 10.1]]
thickness-m = 0.2
closed = true

[[pillar-grid]]
first = [5.0, 5.0]
step = [5.0, 0.0]
columns = 3
rows = 1
without = ["B1"]

[survey]
points = [
  { name = "1", at = [3.0, 2.0] },
  { name = "C", at = [17.0, 2.0], role = "check" },
]
features = [
  { name = "sw", at = [0.0, 0.0] },
  { name = "pillar", kind = "pillar", pillar = "C1" },
]

[[block]]
name = "B1"
start-s = 50
route = [[2.0, 2.0], "1", [16.0, 2.0], "C"]
)";

class ScenarioToml : public testing::Test {
 protected:
  survey::Scenario Read(const std::string& text) {
    std::ofstream(folder_ / "room.toml") << text;
    return ReadScenario(folder_ / "room.toml");
  }
  // The message of the DataError that the text with one change gives.
  std::string ErrorOf(const std::string& from, const std::string& to) {
    std::string text = kRoom;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    try {
      Read(text);
    } catch (const DataError& error) {
      return error.what();
    }
    return "no error";
  }

  test_support::ScratchFolder folder_;
};

TEST_F(ScenarioToml, ReadsUnitsNamesAndPlaces) {
  const survey::Scenario scenario = Read(kRoom);
  EXPECT_EQ(scenario.crs, "EPSG:25832");
  EXPECT_EQ(scenario.seed, 9U);
  EXPECT_DOUBLE_EQ(scenario.lidar.near_sigma_m, 0.02);
  EXPECT_DOUBLE_EQ(scenario.lidar.far_sigma_m, survey::LidarSpec().far_sigma_m);
  EXPECT_NEAR(scenario.imu.gyro_bias_sigma_rad_s, std::numbers::pi / 3600.0, 1e-12);
  EXPECT_NEAR(scenario.imu.accelerometer_bias_sigma_m_s2, 0.01, 1e-12);
  EXPECT_NEAR(scenario.cart.body_from_lidar.theta, std::numbers::pi / 2, 1e-12);
  ASSERT_EQ(scenario.points.size(), 2U);
  EXPECT_EQ(scenario.points[1].role, survey::PointRole::kCheck);
  ASSERT_EQ(scenario.features.size(), 2U);
  EXPECT_EQ(scenario.features[1].position, Eigen::Vector2d(15.0, 5.0));
  ASSERT_EQ(scenario.blocks.size(), 1U);
  ASSERT_EQ(scenario.blocks[0].waypoints.size(), 4U);
  EXPECT_EQ(scenario.blocks[0].waypoints[1].point, "1");
  EXPECT_EQ(scenario.blocks[0].waypoints[3].position, Eigen::Vector2d(17.0, 2.0));
  EXPECT_EQ(survey::BuildFloorPlan(scenario).pillars.size(), 2U);
}

// The specifications of [CN]'s instruments, in the makers' units.
TEST_F(ScenarioToml, DefaultsAreTheInstrumentsOfThePaper) {
  const survey::Scenario defaults = Read(R"(
name = "default"
block = [{ name = "B1", route = [[0.0, 0.0], [5.0, 0.0]] }]
)");
  const survey::Scenario spelled_out = Read(R"(
name = "spelled out"
block = [{ name = "B1", route = [[0.0, 0.0], [5.0, 0.0]] }]
[lidar]
field-of-view-deg = 270
[imu]
gyro-bias-deg-h = 200
gyro-noise-deg-s-rthz = 0.05
accelerometer-bias-mgal = 2000
)");
  EXPECT_NEAR(defaults.lidar.field_of_view_rad, spelled_out.lidar.field_of_view_rad, 1e-12);
  EXPECT_NEAR(defaults.imu.gyro_bias_sigma_rad_s, spelled_out.imu.gyro_bias_sigma_rad_s, 1e-15);
  EXPECT_NEAR(defaults.imu.gyro_noise_rad_s_rthz, spelled_out.imu.gyro_noise_rad_s_rthz, 1e-15);
  EXPECT_NEAR(defaults.imu.accelerometer_bias_sigma_m_s2, spelled_out.imu.accelerometer_bias_sigma_m_s2, 1e-12);
}

TEST_F(ScenarioToml, RefusesWhatItDoesNotKnow) {
  const std::string file = (folder_ / "room.toml").string();
  EXPECT_EQ(ErrorOf("near-sigma-m = 0.02", "near-sigma = 0.02").find(file + ":8: lidar: near-sigma: unknown key"), 0U)
      << ErrorOf("near-sigma-m = 0.02", "near-sigma = 0.02");
  EXPECT_NE(ErrorOf("[lidar]", "[laser]").find("laser: unknown key"), std::string::npos);
  EXPECT_NE(ErrorOf("role = \"check\"", "roll = \"check\"").find("points 2: roll: unknown key"), std::string::npos);
}

TEST_F(ScenarioToml, RefusesBadValuesByNameAndLine) {
  EXPECT_NE(ErrorOf("near-sigma-m = 0.02", "near-sigma-m = -0.02").find("near-sigma-m = -0.02: must be at least 0"),
            std::string::npos);
  EXPECT_NE(ErrorOf("near-sigma-m = 0.02", "near-sigma-m = \"a\"").find("must be a number"), std::string::npos);
  EXPECT_NE(ErrorOf("near-sigma-m = 0.02", "near-sigma-m = nan").find("must be a number"), std::string::npos);
  EXPECT_NE(ErrorOf("seed = 9", "seed = ").find(":5: "), std::string::npos);
  EXPECT_NE(ErrorOf("name = \"C\"", "name = \"1\"").find("there is another point of this name"), std::string::npos);
  EXPECT_NE(ErrorOf("role = \"check\"", "role = \"chec\"").find("must be one of control, check"), std::string::npos);
  EXPECT_NE(ErrorOf("\"1\", [16.0, 2.0]", "\"7\", [16.0, 2.0]").find("there is no point \"7\""), std::string::npos);
  EXPECT_NE(ErrorOf("at = [0.0, 0.0]", "at = [0.0, 0.01]").find("no two faces"), std::string::npos);
  EXPECT_NE(ErrorOf("pillar = \"C1\"", "pillar = \"B1\"").find("there is no pillar"), std::string::npos);
  EXPECT_NE(ErrorOf("[[block]]", "[[person]]\npath = [[1.0, 1.0]]\n[[block]]").find("at least 2 points"),
            std::string::npos);
  EXPECT_NE(ErrorOf("near-sigma-m = 0.02", "rate-hz = 80").find("longer than one turn"), std::string::npos);
}

}  // namespace
}  // namespace formats
