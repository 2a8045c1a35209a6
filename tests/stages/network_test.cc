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
  ExpectRefused(kHeader + "C1,5334000,32690000,0.002,0.002,,\n", "carries the number of a zone in front: 690000", 1,
                {"--crs", "EPSG:25832"});
  ExpectRefused("", "points.csv: holds no points");
}

// A site may lie beyond the border of a zone: told, not refused.
TEST_F(NetworkStageTest, CoordinatesOfAnotherZoneAreTold) {
  Write("points.csv", kHeader +
                          "C1,5334000,-200000,0.002,0.002,,\nC2,5334010,-200000,0.002,0.002,,\n"
                          "C3,5334020,-200000,0.002,0.002,,\nK1,5334030,-200000,0.002,0.002,,\nT1,,,,,tie,\n"
                          "X1,5334040,-200000,0.002,0.002,excluded,disturbed\n");
  const CommandResult result = Run({"--crs", "EPSG:25832"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("points lie outside the area of use of EPSG:25832"), std::string::npos) << result.err;
}

TEST_F(NetworkStageTest, RefusesBadUsage) {
  ExpectRefused(kPoints, "control-order = \"enz\": must be one of", 2, {"--control-order", "enz"});
  ExpectRefused(kPoints, "EPSG:1", 2, {"--crs", "EPSG:1"});
  ExpectRefused(kPoints, "names block B1 twice", 2, {"--marks", "B1=m1.csv", "B1=m2.csv"});
  ExpectRefused(kPoints, "no such file", 1, {"--marks", "B1=nowhere.csv"});
}

// A network of observations: total station at A, B; the points P, K1 to be tied.
const std::string kGkf = R"(<?xml version="1.0"?>
<gama-local><network axes-xy="en" angles="left-handed">
<description>yard</description>
<parameters sigma-apr="1" sigma-act="aposteriori"/>
<points-observations distance-stdev="1" direction-stdev="5">
<point id="A" x="0" y="0" fix="xy"/>
<point id="B" x="100" y="0" fix="xy"/>
<point id="C1" adj="xy"/>
<point id="C2" adj="xy"/>
<point id="K1" adj="xy"/>
<obs from="A"><direction to="B" val="100.0000"/><direction to="C1" val="50.0003"/><direction to="C2" val="29.5164"/>
<direction to="K1" val="70.4835"/><distance to="C1" val="70.7107"/><distance to="C2" val="111.8035"/>
<distance to="K1" val="111.8030"/></obs>
<obs from="B"><direction to="A" val="0.0000"/><direction to="C1" val="49.9999"/><direction to="C2" val="70.4832"/>
<direction to="K1" val="99.9998"/><distance to="C1" val="70.7110"/><distance to="C2" val="111.8033"/>
<distance to="K1" val="50.0010"/></obs>
</points-observations></network></gama-local>
)";

class NetworkAdjustmentTest : public NetworkStageTest {
 protected:
  NetworkAdjustmentTest() {
    Write("n.gkf", kGkf);
    Write("roles.csv", "point,role,reason\nK1,check,\nA,excluded,outside\nB,excluded,outside\n");
    Write("m1.csv", "point,start,end\nC1,1,2\nC2,3,4\n");
    Write("m2.csv", "point,start,end\nC2,1,2\nK1,3,4\n");
  }
  CommandResult RunOn(const std::string& control, std::vector<std::string> more = {}) {
    std::vector<std::string> command = {"plumbline-network", "--control", control,    "--marks",
                                        "B1=m1.csv",         "B2=m2.csv", "--output", "work/control.sqlite",
                                        "--extracts",        "work"};
    command.insert(command.end(), more.begin(), more.end());
    return test_support::RunCommand(command, scratch_.path().string());
  }
  survey::ControlNetwork Control(const std::string& file = "work/control.sqlite") {
    return formats::ReadControl(scratch_ / file);
  }
  void ExpectNetworkRefused(const std::string& from, const std::string& to, const std::string& words) {
    std::string text = kGkf;
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), from.size(), to);
    Write("bad.gkf", text);
    const CommandResult result = RunOn("bad.gkf");
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "work"));
  }
};

TEST_F(NetworkAdjustmentTest, ObservationsBecomeControlWithCovariances) {
  const CommandResult result = RunOn("n.gkf", {"--roles", "roles.csv"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("14 observations, 8 unknowns, sigma zero"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("2 control, 1 check, 0 tie, 2 excluded points"), std::string::npos) << result.err;
  const survey::ControlNetwork control = Control();
  ASSERT_EQ(control.points.size(), 5U);
  EXPECT_LT((control.points[2].position_in_site - Eigen::Vector2d(50, 50)).norm(), 0.002);   // C1
  EXPECT_LT((control.points[3].position_in_site - Eigen::Vector2d(50, 100)).norm(), 0.002);  // C2
  EXPECT_EQ(control.points[4].role, survey::PointRole::kCheck);
  EXPECT_EQ(control.correlations.size(), 3U);
  EXPECT_EQ(control.observations.size(), 14U);
  ASSERT_TRUE(control.adjustment.has_value());
  EXPECT_EQ(control.adjustment->degrees_of_freedom, 6);
  EXPECT_EQ(control.adjustment->description, "yard");
  // The extract holds the block's points with their covariance and nothing else.
  const survey::ControlNetwork extract = Control("work/B1/control.sqlite");
  ASSERT_EQ(extract.points.size(), 2U);
  ASSERT_EQ(extract.correlations.size(), 1U);
  EXPECT_EQ(extract.correlations[0].covariance, control.correlations[0].covariance);
  EXPECT_TRUE(extract.observations.empty());
  EXPECT_FALSE(extract.adjustment.has_value());
  EXPECT_EQ(Bytes("work/B2/control.sqlite").find("K1"), std::string::npos);
  const CommandResult show =
      test_support::RunCommand({"plumbline-show", "work/control.sqlite"}, scratch_.path().string());
  for (const std::string words : {"adjustment of the control network by Plumbline", "sigma zero a posteriori",
                                  "chi-square test (95.0 %)", "adjusted points", "adjusted observations", "MDB"}) {
    EXPECT_NE(show.out.find(words), std::string::npos) << words;
  }
}

// Distances on the ground are longer than on a grid of factor 0.9996, unless the coordinates are ground ones too.
TEST_F(NetworkAdjustmentTest, GroundDistancesAreReduced) {
  std::string text = kGkf;
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{{"70.7107", "70.7390"},
                                                                                 {"111.8035", "111.8482"},
                                                                                 {"111.8030", "111.8477"},
                                                                                 {"70.7110", "70.7393"},
                                                                                 {"111.8033", "111.8480"},
                                                                                 {"50.0010", "50.0210"}}) {
    text.replace(text.find(from), std::string(from).size(), to);
  }
  Write("n.gkf", text);
  ASSERT_EQ(RunOn("n.gkf", {"--distances", "ground", "--combined-factor", "0.9996"}).status, 0);
  EXPECT_LT((Control().points[2].position_in_site - Eigen::Vector2d(50, 50)).norm(), 0.002);
  ASSERT_EQ(Control().remarks.size(), 1U);
  EXPECT_NE(Control().remarks[0].find("combined factor 0.99960000"), std::string::npos);
  EXPECT_EQ(RunOn("n.gkf", {"--distances", "ground"}).status, 2) << "neither a factor nor a crs";
}

TEST_F(NetworkAdjustmentTest, SiteGridIsTied) {
  Write("tie.csv",
        "point,x,y,easting,northing\nA,0,0,690000,5334000\nB,100,0,690000,5334100\nQ,0,100,689900,5334000\n");
  Write("points.csv", kPoints);
  Write("m1.csv", "point,start,end\nC1,1,2\n");
  Write("m2.csv", "point,start,end\nC2,1,2\n");
  const CommandResult result = RunOn("points.csv", {"--grid-tie", "tie.csv", "--crs", "EPSG:25832"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("rotation 100.0000 gon, scale 1.00000000"), std::string::npos) << result.err;
  EXPECT_LT((Control().points[0].position_in_site - Eigen::Vector2d(689990, 5334020)).norm(), 1e-6);  // C1: x 20, y 10
  Write("tie.csv", "point,x,y,easting,northing\nA,0,0,690000,5334000\n");
  const CommandResult refused = RunOn("points.csv", {"--grid-tie", "tie.csv", "--crs", "EPSG:25832"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("tie.csv: two points at least"), std::string::npos) << refused.err;
}

TEST_F(NetworkAdjustmentTest, BadNetworksAreNamed) {
  const std::string none = "fix=\"xy\"/>\n<point id=\"B\" x=\"100\" y=\"0\" fix=\"xy\"";
  ExpectNetworkRefused(
      none, "adj=\"xy\"/>\n<point id=\"B\" x=\"100\" y=\"0\" adj=\"xy\"",
      "bad.gkf: the network has no datum: shift in x, shift in y, rotation of the whole network is open");
  ExpectNetworkRefused("<point id=\"C1\" adj", "<point id=\"Z\" adj=\"xy\"/><point id=\"C1\" adj",
                       "bad.gkf: no observation leads to Z");
  ExpectNetworkRefused("</points-observations>",
                       "<point id=\"Y\" adj=\"xy\"/><obs from=\"A\"><direction to=\"B\" val=\"1\"/><direction to=\"Y\" "
                       "val=\"9\"/></obs></points-observations>",
                       "bad.gkf: point Y is observed from one side only (direction from A to Y)");
  ExpectNetworkRefused("</points-observations>",
                       "<point id=\"Y\" adj=\"xy\"/><point id=\"Z\" adj=\"xy\"/><obs from=\"Y\"><distance to=\"Z\" "
                       "val=\"9\"/></obs></points-observations>",
                       "Y and Z are not connected with the fixed or constrained points");
  ExpectNetworkRefused("distance-stdev=\"1\"", "distance-stdev=\"5000000\"", "is its unit right?");
  ExpectNetworkRefused("distance-stdev=\"1\"", "distance-stdev=\"0\"", "has no standard deviation");
  ExpectNetworkRefused("70.7107", "70,7107", "decimal comma");
  ExpectNetworkRefused("<gama-local>", "<!DOCTYPE g [<!ENTITY a \"b\">]><gama-local>",
                       "entity declarations are refused");
}

TEST_F(NetworkAdjustmentTest, UndeterminedPointsMayBeLeftOut) {
  std::string text = kGkf;
  text.replace(text.find("<point id=\"C1\""), 0, "<point id=\"Z\" adj=\"xy\"/>");
  Write("n.gkf", text);
  const CommandResult result = RunOn("n.gkf", {"--undetermined-points", "leave-out"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("no observation leads to Z; left out"), std::string::npos) << result.err;
  EXPECT_EQ(Control().points.size(), 5U);
}

TEST_F(NetworkAdjustmentTest, OutliersAreReportedAndKept) {
  std::string text = kGkf;
  text.replace(text.find("50.0010"), 7, "50.0210");
  Write("n.gkf", text);
  const CommandResult result = RunOn("n.gkf");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("1 observations of the control network are suspected outliers; none is left out"),
            std::string::npos)
      << result.err;
  const survey::ControlNetwork control = Control();
  EXPECT_EQ(control.adjustment->num_suspected, 1);
  EXPECT_EQ(control.observations.back().suspected, 1);
}

TEST_F(NetworkAdjustmentTest, OneControlFile) {
  const CommandResult result = RunOn("n.gkf", {"--control", "n.gkf", "points.csv"});
  EXPECT_NE(result.status, 0);
  const CommandResult roles = RunOn("n.gkf", {"--roles", "m1.csv"});
  EXPECT_EQ(roles.status, 1) << "wrong header";
  Write("roles.csv", "point,role,reason\nQQ,check,\n");
  const CommandResult unknown = RunOn("n.gkf", {"--roles", "roles.csv"});
  EXPECT_NE(unknown.err.find("roles.csv:2: point QQ is not in the control"), std::string::npos) << unknown.err;
}

}  // namespace
