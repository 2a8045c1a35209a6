// SPDX-License-Identifier: Apache-2.0
//
// plumbline-plan from a floor plan: nobody has walked the block yet.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "tests/support/command.h"
#include "tests/support/paths.h"
#include "tests/support/scratch_folder.h"

namespace {

using nlohmann::json;

class Plan : public testing::Test {
 protected:
  test_support::CommandResult Run(const std::vector<std::string>& more) {
    std::vector<std::string> command = {"plumbline-plan", "--output", (folder_ / "plan.json").string()};
    command.insert(command.end(), more.begin(), more.end());
    return test_support::RunCommand(command);
  }
  std::vector<std::string> OfTwoRooms(const std::string& block) const {
    return {"--floor-plan", (test_support::SourceFolder() / "tests" / "jobs" / "two_rooms.toml").string(), "--block",
            block};
  }
  test_support::ScratchFolder folder_;
};

TEST_F(Plan, ChoosesPointsInAFloorPlan) {
  std::vector<std::string> arguments = OfTwoRooms("A");
  for (const std::string& more : {std::string("--keep-points=false"), std::string("--max-points"), std::string("5"),
                                  std::string("--picture"), (folder_ / "plan.svg").string()})
    arguments.push_back(more);
  const test_support::CommandResult result = Run(arguments);
  ASSERT_EQ(result.status, 0) << result.err;
  const json plan = json::parse(formats::ReadWholeFile(folder_ / "plan.json"));
  EXPECT_EQ(plan["tied"], true);
  const json& points = plan["points"];
  ASSERT_EQ(points.size(), 5U);
  for (std::size_t i = 2; i < points.size(); ++i) EXPECT_LT(points[i]["rms_m"], points[i - 1]["rms_m"]) << i;
  for (const json& point : points) EXPECT_EQ(point["existing"], false);
  const std::string picture = formats::ReadWholeFile(folder_ / "plan.svg");
  EXPECT_NE(picture.find("class=\"wall\""), std::string::npos);
}

// In the order of the route, at the coordinates of the plan.
TEST_F(Plan, PointsOfTheRouteComeFirst) {
  const test_support::CommandResult result = Run(OfTwoRooms("A"));
  ASSERT_EQ(result.status, 0) << result.err;
  const json points = json::parse(formats::ReadWholeFile(folder_ / "plan.json"))["points"];
  EXPECT_EQ(points[0]["existing"], true);
  EXPECT_EQ(points[0]["name"], "2");
  EXPECT_NE(result.err.find("predicted rms"), std::string::npos);
}

TEST_F(Plan, NamesWhatIsMissing) {
  const test_support::CommandResult unknown = Run(OfTwoRooms("B9"));
  EXPECT_EQ(unknown.status, 1);
  EXPECT_NE(unknown.err.find("has no block \"B9\"; it has A, B"), std::string::npos) << unknown.err;
  EXPECT_EQ(Run({}).status, 2);
  const test_support::CommandResult half = Run({OfTwoRooms("A")[0], OfTwoRooms("A")[1]});
  EXPECT_EQ(half.status, 2);
  EXPECT_NE(half.err.find("--floor-plan and --block"), std::string::npos) << half.err;
}

}  // namespace
