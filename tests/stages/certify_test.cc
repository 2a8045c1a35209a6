// SPDX-License-Identifier: Apache-2.0
//
// certify and report through their executables, on solutions made by hand.
#include <gtest/gtest.h>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/certificate_file.h"
#include "formats/joint_file.h"
#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace {

using survey::PointRole;
using test_support::CommandResult;

const formats::Provenance kProvenance = {.records = {{.stage = "adjust", .version = "1"}}};
const Eigen::Matrix2d kSurvey = Eigen::Matrix2d::Identity() * 4e-6;

class CertifyStageTest : public testing::Test {
 protected:
  CertifyStageTest() {
    survey::ControlNetwork network;
    for (int i = 0; i < 8; ++i) {
      network.points.push_back({.name = "P" + std::to_string(i),
                                .role = i < 3 ? PointRole::kControl : PointRole::kCheck,
                                .position_in_site = {10.0 * i, 5.0 * (i % 2)},
                                .covariance = kSurvey});
    }
    network_ = network;
    formats::WriteControl(scratch_ / "control.sqlite", network, kProvenance);
    WriteBlock("B1.sqlite", 0.01);
  }

  // Marks on all points, off by `error_m` east; P0 to P2 were used.
  void WriteBlock(const std::string& name, double error_m, bool tied = true, bool check_used = false,
                  const std::string& version = "1") {
    survey::Solution solution{.tied = tied};
    std::vector<survey::ScanStamp> stamps;
    for (std::int64_t i = 0; i < 8; ++i) {
      const survey::ControlPoint& point = network_.points[static_cast<std::size_t>(i)];
      const Eigen::Vector2d at = point.position_in_site + Eigen::Vector2d(i < 3 ? 0.001 : error_m, 0);
      solution.scans.push_back(
          {.scan = survey::ScanId{static_cast<int>(i)}, .site_from_scan = {at.x(), at.y(), 0}, .is_node = true});
      stamps.push_back({.clock_ns = 1000 * i, .recorded_ns = 1000 * i});
      solution.marks.push_back({.point = point.name,
                                .start_ns = 1000 * i,
                                .end_ns = 1000 * i + 10,
                                .scan = survey::ScanId{static_cast<int>(i)},
                                .used = tied && (i < 3 || (check_used && i == 4)),
                                .position_in_site = at,
                                .residual = {i < 3 ? 0.001 : 0.0, 0}});
    }
    formats::WriteSolution(scratch_ / name, solution, stamps, {.records = {{.stage = "adjust", .version = version}}});
  }
  CommandResult Run(std::vector<std::string> more = {}) {
    std::vector<std::string> command = {"plumbline-certify", "--control", "control.sqlite",      "--solution",
                                        "B1=B1.sqlite",      "--output",  "out/certificate.json"};
    command.insert(command.end(), more.begin(), more.end());
    return test_support::RunCommand(command, scratch_.path().string());
  }
  survey::Certificate Certificate() { return formats::ReadCertificate(scratch_ / "out/certificate.json"); }
  std::string Bytes(const std::string& name) { return formats::ReadWholeFile(scratch_ / name); }

  test_support::ScratchFolder scratch_;
  survey::ControlNetwork network_;
};

TEST_F(CertifyStageTest, TestsTheCheckPoints) {
  const CommandResult result = Run({"--accuracy-class-m", "0.05", "--site-title", "Garage"});
  ASSERT_EQ(result.status, 0) << result.err;
  const survey::Certificate c = Certificate();
  EXPECT_EQ(c.site, "Garage");
  EXPECT_EQ(c.points_test.statistics.num_points, 5);
  EXPECT_NEAR(c.points_test.statistics.rmse, 0.01, 1e-9);
  EXPECT_EQ(c.fit.size(), 3U);
  EXPECT_TRUE(*c.statement.meets);
  EXPECT_NE(result.err.find("check points: RMSE_H 12.6 mm (n = 5); class met"), std::string::npos) << result.err;
}

TEST_F(CertifyStageTest, TestsTheFeaturesOfThisSolutionsMap) {
  const formats::Provenance solution = formats::ReadProvenance(scratch_ / "B1.sqlite");
  formats::Provenance features{.records = {{.stage = "features", .version = "1"}, solution.Own()}};
  formats::WriteFeatures(
      scratch_ / "f.sqlite",
      {{.name = "F1", .found = true, .position_in_site = {5.0, 1.03}}, {.name = "F2", .reason = "hidden"}}, features);
  formats::WriteFileAtomically(scratch_ / "features.csv",
                               "name,northing,easting,sigma_n,sigma_e,kind\nF1,1,5,0.003,0.003,corner\n"
                               "F2,1,9,0.003,0.003,pillar\n");
  const std::vector<std::string> more = {"--features", "B1=f.sqlite", "--feature-list", "features.csv"};
  const CommandResult result = Run(more);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(Certificate().features_test.statistics.num_points, 1);
  EXPECT_NEAR(Certificate().features_test.statistics.rmse, 0.03, 1e-9);
  EXPECT_EQ(Certificate().statement.tested_on, "check features");
  WriteBlock("B1.sqlite", 0.02, true, false, "another run");
  const CommandResult stale = Run(more);
  EXPECT_EQ(stale.status, 1);
  EXPECT_NE(stale.err.find("f.sqlite: was not measured in the map of B1.sqlite"), std::string::npos) << stale.err;
  const CommandResult unknown = Run({"--features", "B7=f.sqlite", "--feature-list", "features.csv"});
  EXPECT_EQ(unknown.status, 2) << unknown.err;
}

TEST_F(CertifyStageTest, RefusesAFeatureThatIsControl) {
  formats::WriteFileAtomically(scratch_ / "features.csv",
                               "name,northing,easting,sigma_n,sigma_e,kind\nP1,1,5,0.003,0.003,corner\n");
  const CommandResult result = Run({"--feature-list", "features.csv"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("check feature P1 bears the name of a point of the control list"), std::string::npos)
      << result.err;
}

TEST_F(CertifyStageTest, RepeatsTheSeams) {
  const std::string seams = R"({"format": "plumbline-seams", "format_version": 2, "seams": [{"blocks": ["B1", "B2"],
      "overlap_area_m2": 80.5, "contradicted_shares": [0.01, 0.02], "rms_m": null, "patches": [{}, {}],
      "sigmas": 3.5, "contradicts": true}],
      "provenance": )" + formats::JsonTextOf(kProvenance) +
                            "}";
  formats::WriteFileAtomically(scratch_ / "seams.json", seams);
  const CommandResult result = Run({"--seams", "seams.json"});
  ASSERT_EQ(result.status, 0) << result.err;
  ASSERT_EQ(Certificate().stitching.seams.size(), 1U);
  EXPECT_EQ(Certificate().stitching.seams[0].num_windows, 2);
  EXPECT_EQ(Certificate().stitching.seams[0].contradicted_share, 0.02);
  EXPECT_EQ(Certificate().stitching.seams[0].sigmas, 3.5);
  EXPECT_EQ(Certificate().stitching.seams[0].contradicts, true);
  formats::WriteFileAtomically(scratch_ / "seams.json", seams.substr(0, 60));
  EXPECT_EQ(Run({"--seams", "seams.json"}).status, 1);
}

TEST_F(CertifyStageTest, RepeatsTheJointAdjustment) {
  const survey::JointSummary joint{
      .num_control_points = 3,
      .blocks = {{.name = "B1", .rms_shift = 0.002, .max_shift = 0.004}},
      .pairs = {{.block_a = "B1", .block_b = "B2", .num_matches = 9, .contradicts = true}}};
  formats::WriteJoint(scratch_ / "joint.json", joint, kProvenance);
  const CommandResult result = Run({"--joint", "joint.json"});
  ASSERT_EQ(result.status, 0) << result.err;
  ASSERT_TRUE(Certificate().joint);
  EXPECT_EQ(Certificate().joint->blocks.at(0).max_shift, 0.004);
  EXPECT_TRUE(Certificate().joint->pairs.at(0).contradicts);
  formats::WriteFileAtomically(scratch_ / "joint.json", formats::ReadWholeFile(scratch_ / "joint.json").substr(0, 60));
  const CommandResult cut_off = Run({"--joint", "joint.json"});
  EXPECT_EQ(cut_off.status, 1);
  EXPECT_NE(cut_off.err.find("joint.json: is not a joint.json"), std::string::npos) << cut_off.err;
}

TEST_F(CertifyStageTest, AClassThatIsNotMetIsAVerdictNotAFailure) {
  const CommandResult result = Run({"--accuracy-class-m", "0.005"});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("class NOT met"), std::string::npos) << result.err;
  EXPECT_FALSE(*Certificate().statement.meets);
}

TEST_F(CertifyStageTest, AnOfficeAddsItsClasses) {
  const std::string added = "[[class]]\nstandard = \"Contract 7\"\nname = \"plan\"\nstatistic = \"rmse-axis\"\n";
  formats::WriteFileAtomically(scratch_ / "classes.toml", added + "limit_m = 0.011\n");
  ASSERT_EQ(Run({"--classes", "classes.toml"}).status, 0);
  const std::vector<survey::ClassResult> classes = Certificate().points_analysis.classes;
  ASSERT_EQ(classes.size(), 11U);  // four of LOA, six of DIN 18710 and the office's; none asked for, none in multiples
  EXPECT_EQ(classes.front().accuracy_class.name, "LOA20");
  EXPECT_EQ(classes.back().accuracy_class.standard, "Contract 7");
  EXPECT_TRUE(classes.back().meets);
  EXPECT_FALSE(classes.back().demonstrated);
  ASSERT_EQ(Run({"--classes", "classes.toml", "--accuracy-class-m", "0.05"}).status, 0);
  EXPECT_EQ(Certificate().points_analysis.classes.size(), 13U);
  const std::string before = Bytes("out/certificate.json");
  for (const auto& [bad, message] : {std::pair{"limit_m = -1\n", "limit_m"},
                                     {"limit = 1\n", "needs either limit_m or times_class"},
                                     {"limit_m = 1\nsigma = 2\n", "sigma"}}) {
    formats::WriteFileAtomically(scratch_ / "classes.toml", added + bad);
    const CommandResult result = Run({"--classes", "classes.toml"});
    EXPECT_EQ(result.status, 1) << bad;
    EXPECT_NE(result.err.find("classes.toml"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
  }
  EXPECT_EQ(Bytes("out/certificate.json"), before);
}

TEST_F(CertifyStageTest, NamesWhatIsFarFromControl) {
  ASSERT_EQ(Run({"--far-from-control-m", "25"}).status, 0);
  const std::vector<std::string> list = Certificate().not_tested;
  EXPECT_NE(std::find(list.begin(), list.end(),
                      "Block B1: 34 m of its path lie farther than 25 m from its control, the farthest place (E 70, N "
                      "5) 50 m: the map is extrapolated there."),
            list.end())
      << testing::PrintToString(list);
}

TEST_F(CertifyStageTest, NoneAndOneCheck) {
  network_.points.resize(4);
  formats::WriteControl(scratch_ / "control.sqlite", network_, kProvenance);
  ASSERT_EQ(Run({"--accuracy-class-m", "0.05"}).status, 0);
  EXPECT_NE(Certificate().statement.asprs.find("using ONLY 1 checkpoint."), std::string::npos);
  EXPECT_FALSE(*Certificate().statement.demonstrated);
  network_.points.resize(3);
  formats::WriteControl(scratch_ / "control.sqlite", network_, kProvenance);
  ASSERT_EQ(Run({"--accuracy-class-m", "0.05"}).status, 0);
  EXPECT_NE(Certificate().statement.asprs.find("was produced to meet"), std::string::npos);
  EXPECT_FALSE(Certificate().statement.meets.has_value());
}

TEST_F(CertifyStageTest, RefusesACheckThatWasControl) {
  ASSERT_EQ(Run().status, 0);
  const std::string before = Bytes("out/certificate.json");
  WriteBlock("B1.sqlite", 0.01, true, true);
  const CommandResult result = Run();
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("point P4 was used as control in the solution of block B1 but its role is check"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(Bytes("out/certificate.json"), before);
}

TEST_F(CertifyStageTest, BlocksWithoutControlAreNotCertified) {
  WriteBlock("B1.sqlite", 0.01, false);
  ASSERT_EQ(
      test_support::RunCommand({"plumbline-certify", "--solution", "B1=B1.sqlite", "--output", "out/certificate.json"},
                               scratch_.path().string())
          .status,
      0);
  EXPECT_FALSE(Certificate().tied);
  EXPECT_TRUE(Certificate().statement.asprs.empty());
  ASSERT_EQ(test_support::RunCommand({"plumbline-report", "--certificate", "out/certificate.json", "--solution",
                                      "B1=B1.sqlite", "--output", "page.html"},
                                     scratch_.path().string())
                .status,
            0);
  EXPECT_NE(Bytes("page.html").find("NOT TIED TO CONTROL"), std::string::npos);
  EXPECT_NE(Bytes("page.html").find("<h1>Map report</h1>"), std::string::npos);
}

TEST_F(CertifyStageTest, TheSameInputsGiveTheSameBytes) {
  const std::vector<std::string> report = {"plumbline-report", "--certificate", "out/certificate.json",
                                           "--solution",       "B1=B1.sqlite",  "--output",
                                           "page.html"};
  ASSERT_EQ(Run().status, 0);
  ASSERT_EQ(test_support::RunCommand(report, scratch_.path().string()).status, 0);
  const std::string certificate = Bytes("out/certificate.json"), page = Bytes("page.html");
  std::filesystem::remove_all(scratch_ / "out");
  ASSERT_EQ(Run({"--threads", "1"}).status, 0);
  ASSERT_EQ(test_support::RunCommand(report, scratch_.path().string()).status, 0);
  EXPECT_EQ(Bytes("out/certificate.json"), certificate);
  EXPECT_EQ(Bytes("page.html"), page);
}

TEST_F(CertifyStageTest, ReportWritesLayersForGisAndCad) {
  ASSERT_EQ(Run({"--accuracy-class-m", "0.05"}).status, 0);
  const auto report = [&] {
    return test_support::RunCommand(
        {"plumbline-report", "--certificate", "out/certificate.json", "--solution", "B1=B1.sqlite", "--geopackage",
         "site.gpkg", "--project", "site.qgs", "--dxf", "site.dxf", "--output", "page.html"},
        scratch_.path().string());
  };
  const CommandResult first = report();
  ASSERT_EQ(first.status, 0) << first.err;
  const auto info = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "ogrinfo");
    const CommandResult result = test_support::RunCommand(arguments, scratch_.path().string());
    EXPECT_EQ(result.err, "");
    return result.out;
  };
  const std::string layers = info({"-al", "-so", "site.gpkg"});
  for (const std::string layer : {"trajectories", "ellipses", "residual_vectors", "seams", "control", "checks"}) {
    EXPECT_NE(layers.find("Layer name: " + layer + "\n"), std::string::npos) << layers;
  }
  // P3 lies at (30, 5) and was found 10 mm east; 8 vectors are drawn a round number of times too large.
  const std::string vectors = info({"-al", "-where", "name='P3'", "site.gpkg", "residual_vectors"});
  EXPECT_NE(vectors.find("evidence (String) = tested"), std::string::npos) << vectors;
  EXPECT_NE(vectors.find("de_mm (Real) = 10"), std::string::npos) << vectors;
  EXPECT_NE(vectors.find("enlargement (Real) = 200"), std::string::npos) << vectors;  // 5 % of 70 m over 10 mm: 350
  EXPECT_NE(vectors.find("LINESTRING (30 5,32"), std::string::npos) << vectors;
  EXPECT_NE(info({"-al", "site.gpkg", "layer_styles"}).find("useAsDefault (Integer(Boolean)) = 1"), std::string::npos);
  EXPECT_NE(info({"site.gpkg"}).find("PLUMBLINE_PROVENANCE"), std::string::npos);
  const std::string drawing = info({"-al", "-where", "Layer='control'", "site.dxf"});
  EXPECT_NE(drawing.find("Feature Count: 16"), std::string::npos) << drawing;  // eight points, eight names
  const std::string project = Bytes("site.qgs");
  for (const std::string layer : {"trajectories", "ellipses", "residual_vectors", "seams", "control", "checks"}) {
    EXPECT_NE(project.find("<datasource>./site.gpkg|layername=" + layer + "</datasource>"), std::string::npos) << layer;
  }
  const std::string geopackage = Bytes("site.gpkg"), dxf = Bytes("site.dxf");
  std::filesystem::remove(scratch_ / "site.gpkg");
  ASSERT_EQ(report().status, 0);
  EXPECT_EQ(Bytes("site.gpkg"), geopackage);
  EXPECT_EQ(Bytes("site.dxf"), dxf);
}

TEST_F(CertifyStageTest, PrintsThePageOrSaysWhyNot) {
  formats::WriteFileAtomically(scratch_ / "page.html", "<html lang=\"en\"><head><title>t</title></head>x</html>");
  const auto print = [&](const std::string& pdf) {
    return test_support::RunCommand({"plumbline-print", "--page", "page.html", "--output", pdf},
                                    scratch_.path().string());
  };
  const CommandResult first = print("a.pdf");
  if (first.status == 1 && first.err.find("WeasyPrint is not installed") != std::string::npos) GTEST_SKIP();
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_TRUE(Bytes("a.pdf").starts_with("%PDF-"));
  // What PDF/A-3b asks of every file [ISO 19005-3]: the claim in the metadata, colours that mean the same everywhere,
  // fonts inside, nothing hidden or running.
  for (const char* marker : {"pdfaid:part=\"3\"", "pdfaid:conformance=\"B\"", "/GTS_PDFA1", "/FontFile2"})
    EXPECT_NE(Bytes("a.pdf").find(marker), std::string::npos) << marker;
  for (const char* banned : {"/Encrypt", "/JavaScript", "/Launch", "/LZWDecode"})
    EXPECT_EQ(Bytes("a.pdf").find(banned), std::string::npos) << banned;
  ASSERT_EQ(print("b.pdf").status, 0);
  EXPECT_EQ(Bytes("a.pdf"), Bytes("b.pdf"));
}

TEST_F(CertifyStageTest, ReportRefusesACutCertificate) {
  ASSERT_EQ(Run().status, 0);
  formats::WriteFileAtomically(scratch_ / "cut.json", Bytes("out/certificate.json").substr(0, 700));
  const CommandResult result = test_support::RunCommand(
      {"plumbline-report", "--certificate", "cut.json", "--output", "page.html"}, scratch_.path().string());
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("cut.json"), std::string::npos) << result.err;
}

}  // namespace
