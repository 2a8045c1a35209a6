// SPDX-License-Identifier: Apache-2.0
//
// The network stage through its executable: what each block may see, what a change reaches, and refusals.
#include <gtest/gtest.h>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace {

using test_support::CommandResult;

const std::string kHeader = "point,northing,easting,sigma_n,sigma_e,role,reason\n";
const std::string kPoints = kHeader +
                            "C1,10,20,0.002,0.002,control,\n"
                            "C2,10,40,0.002,0.002,,\n"
                            "C3,30,40,0.002,0.002,control,\n"
                            "K1,20,30,0.002,0.002,check,\n"
                            "T1,,,,,tie,\n"
                            "X1,30,20,0.002,0.002,excluded,disturbed by works\n";

class NetworkStageTest : public testing::Test {
 protected:
  NetworkStageTest() {
    Write("points.csv", kPoints);
    Write("m1.csv", "point,start,end\nC1,1,2\nK1,3,4\nT1,5,6\nX1,7,8\nC2,9,10\n");
    Write("m2.csv", "point,start,end\nC2,1,2\nC3,3,4\nC2,5,6\n");
  }
  void Write(const std::string& name, const std::string& text) { formats::WriteFileAtomically(scratch_ / name, text); }
  std::string Bytes(const std::string& name) { return formats::ReadWholeFile(scratch_ / name); }
  CommandResult Run(std::vector<std::string> more = {}) {
    std::vector<std::string> command = {"plumbline-network", "--control", "points.csv", "--marks",
                                        "B1=m1.csv",         "B2=m2.csv", "--output",   "work/control.sqlite",
                                        "--extracts",        "work"};
    command.insert(command.end(), more.begin(), more.end());
    return test_support::RunCommand(command, scratch_.path().string());
  }
  void ExpectRefused(const std::string& points, const std::string& words, int status = 1,
                     const std::vector<std::string>& more = {}) {
    if (!std::filesystem::exists(scratch_ / "work")) {
      ASSERT_EQ(Run().status, 0);
    }
    const std::string before = Bytes("work/control.sqlite"), extract = Bytes("work/B1/control.sqlite");
    Write("points.csv", points);
    const CommandResult result = Run(more);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_EQ(Bytes("work/control.sqlite"), before) << "an old output was touched";
    EXPECT_EQ(Bytes("work/B1/control.sqlite"), extract) << "an old output was touched";
    Write("points.csv", kPoints);
  }
  std::vector<std::string> Names(const std::string& file) {
    std::vector<std::string> names;
    for (const auto& point : formats::ReadControl(scratch_ / file).points) names.push_back(point.name);
    return names;
  }
  test_support::ScratchFolder scratch_;
};

TEST_F(NetworkStageTest, ExtractsHoldNeitherChecksNorExcludedPoints) {
  const CommandResult result = Run();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("3 control, 1 check, 1 tie, 1 excluded points"), std::string::npos) << result.err;
  EXPECT_EQ(Names("work/control.sqlite"), (std::vector<std::string>{"C1", "C2", "C3", "K1", "T1", "X1"}));
  EXPECT_EQ(Names("work/B1/control.sqlite"), (std::vector<std::string>{"C1", "C2", "T1"}));
  EXPECT_EQ(Names("work/B2/control.sqlite"), (std::vector<std::string>{"C2", "C3"}));
  for (const std::string file : {"work/B1/control.sqlite", "work/B2/control.sqlite"}) {
    EXPECT_EQ(Bytes(file).find("K1"), std::string::npos) << "a check point is in " << file;
  }
}

TEST_F(NetworkStageTest, AChangeReachesOnlyTheBlocksThatUseThePoint) {
  ASSERT_EQ(Run().status, 0);
  const std::string all = Bytes("work/control.sqlite"), b1 = Bytes("work/B1/control.sqlite"),
                    b2 = Bytes("work/B2/control.sqlite");
  Write("points.csv", "# checked on site\n" + kPoints + "\n# end\n");
  ASSERT_EQ(Run().status, 0);
  EXPECT_EQ(Bytes("work/control.sqlite"), all) << "a comment changed the network";
  std::string moved = kPoints;
  moved.replace(moved.find("C3,30,40"), 8, "C3,30,41");
  Write("points.csv", moved);
  ASSERT_EQ(Run().status, 0);
  EXPECT_NE(Bytes("work/control.sqlite"), all);
  EXPECT_EQ(Bytes("work/B1/control.sqlite"), b1) << "C3 is not marked in B1";
  EXPECT_NE(Bytes("work/B2/control.sqlite"), b2);
}

TEST_F(NetworkStageTest, AMovedCheckPointReachesNoBlock) {
  ASSERT_EQ(Run().status, 0);
  const std::string b1 = Bytes("work/B1/control.sqlite");
  std::string moved = kPoints;
  moved.replace(moved.find("K1,20,30"), 8, "K1,21,30");
  Write("points.csv", moved);
  ASSERT_EQ(Run().status, 0);
  EXPECT_EQ(Bytes("work/B1/control.sqlite"), b1);
}

TEST_F(NetworkStageTest, WorksWithoutControlAndWithoutMarks) {
  EXPECT_EQ(test_support::RunCommand({"plumbline-network", "--output", "a.sqlite"}, scratch_.path().string()).status,
            0);
  EXPECT_TRUE(Names("a.sqlite").empty());
  // Without a list all marked points are places known by name.
  const CommandResult result =
      test_support::RunCommand({"plumbline-network", "--marks", "B1=m2.csv", "--output", "b.sqlite", "--extracts", "w"},
                               scratch_.path().string());
  EXPECT_EQ(result.status, 0) << result.err;
  const survey::ControlNetwork extract = formats::ReadControl(scratch_ / "w/B1/control.sqlite");
  ASSERT_EQ(extract.points.size(), 2U);
  EXPECT_EQ(extract.points[0].role, survey::PointRole::kTie);
}

TEST_F(NetworkStageTest, BlocksWithoutControlGetAnEmptyExtract) {
  Write("m1.csv", "point,start,end\nK1,1,2\n");
  ASSERT_EQ(Run().status, 0);
  EXPECT_TRUE(Names("work/B1/control.sqlite").empty());
}

TEST_F(NetworkStageTest, MarksOnUnknownPoints) {
  Write("m2.csv", "point,start,end\nC2,1,2\n# c\nc4,3,4\n");
  const CommandResult refused = Run();
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("m2.csv:4: point c4 is not in the control list; did you mean C1 or C2 or C3?"),
            std::string::npos)
      << refused.err;
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "work"));
  ASSERT_EQ(Run({"--unknown-points", "tie"}).status, 0);
  EXPECT_EQ(Names("work/B2/control.sqlite"), (std::vector<std::string>{"C2", "c4"}));
}

TEST_F(NetworkStageTest, RefusesBadControlAndKeepsOldOutputs) {
  ExpectRefused(kHeader + "C1,10,20,0.002\n", "points.csv:2: 4 fields, expected 7");
  ExpectRefused(kHeader + "C1,10,,0.002,0.002,,\n", "points.csv:2: easting is missing");
  ExpectRefused(kHeader + "C1,10,NaN,0.002,0.002,,\n", "points.csv:2: easting = \"NaN\": must be a finite number");
  ExpectRefused(kHeader + "C1,10,20,-0.002,0.002,,\n", "points.csv:2: sigma_n = -0.002: a sigma must be positive");
  ExpectRefused(kPoints + "C1,10,20.5,0.002,0.002,,\n", "points.csv:8: point C1 is already in row 2 with other");
  ExpectRefused(kPoints + "K1,20,30,0.002,0.002,control,\n", "as check, here it is control: a point has one role");
  ExpectRefused(kPoints + "K2,10.02,20,0.002,0.002,check,\n", "check point K2 is the same place as control point C1");
  ExpectRefused("C1,10,20\nC2,10,40\n", "points.csv:1: the file has no header, so the order");
  ExpectRefused(kHeader + "C1,690000,5334000,0.002,0.002,,\n", "northing and easting look exchanged", 1,
                {"--crs", "EPSG:25832"});
  ExpectRefused("", "points.csv: holds no points");
}

TEST_F(NetworkStageTest, RefusesBadUsage) {
  ExpectRefused(kPoints, "control-order = \"enz\": must be one of", 2, {"--control-order", "enz"});
  ExpectRefused(kPoints, "EPSG:1", 2, {"--crs", "EPSG:1"});
  ExpectRefused(kPoints, "names block B1 twice", 2, {"--marks", "B1=m1.csv", "B1=m2.csv"});
  ExpectRefused(kPoints, "no such file", 1, {"--marks", "B1=nowhere.csv"});
}

}  // namespace
