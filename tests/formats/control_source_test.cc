// SPDX-License-Identifier: Apache-2.0
//
// Control in the files of other programs.
#include "formats/control_source.h"

#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/grid_scale.h"
#include "formats/site_metric.h"
#include "formats/tie_csv.h"
#include "tests/support/scratch_folder.h"

namespace {

using formats::ControlSource;
using formats::ControlSourceOptions;

class ControlSourceTest : public testing::Test {
 protected:
  ControlSource Read(const std::string& name, const std::string& text, const ControlSourceOptions& options = {}) {
    formats::WriteFileAtomically(scratch_ / name, text);
    return formats::ReadControlSource(scratch_ / name, options);
  }
  void ExpectRefused(const std::string& name, const std::string& text, const std::string& words,
                     const ControlSourceOptions& options = {}) {
    try {
      Read(name, text, options);
      ADD_FAILURE() << "accepted; expected: " << words;
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
  test_support::ScratchFolder scratch_;
};

std::string LandXml(const std::string& points, const std::string& unit = "<Metric linearUnit=\"meter\"/>") {
  return "<?xml version=\"1.0\"?><LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\"><Units>" + unit +
         "</Units><CoordinateSystem epsgCode=\"25832\"/><CgPoints>" + points + "</CgPoints></LandXML>";
}

TEST_F(ControlSourceTest, LandXmlIsNorthEastElevation) {
  const ControlSource source =
      Read("c.xml", LandXml("<CgPoint name=\"K2\" desc=\"bolt\">5334010.5 690000.25 512.1</CgPoint>"
                            "<CgPoint name=\"K1\">5334000 690001</CgPoint><CgPoint pntRef=\"K1\"/>"));
  ASSERT_EQ(source.control.points.size(), 2U);
  EXPECT_EQ(source.control.points[0].name, "K1");
  EXPECT_EQ(source.control.points[1].position_in_site, Eigen::Vector2d(690000.25, 5334010.5));
  EXPECT_EQ(source.control.points[1].elevation_m, 512.1);
  EXPECT_EQ(source.control.points[1].description, "bolt");
  EXPECT_EQ(source.num_default_sigmas, 2);
  EXPECT_EQ(source.warnings.size(), 1U);
  const ControlSource feet =
      Read("c.xml", LandXml("<CgPoint name=\"A\">3937 0</CgPoint>", "<Imperial linearUnit=\"USSurveyFoot\"/>"));
  EXPECT_NEAR(feet.control.points[0].position_in_site.y(), 1200.0, 1e-9);
}

TEST_F(ControlSourceTest, LandXmlRefusals) {
  ExpectRefused("c.xml", LandXml("<CgPoint name=\"K\">1</CgPoint>"),
                "expected northing, easting and perhaps elevation");
  ExpectRefused("c.xml", LandXml("<CgPoint name=\"K\">1,5 2</CgPoint>"), "decimal comma");
  ExpectRefused("c.xml", LandXml("<CgPoint>1 2</CgPoint>"), "attribute name is missing");
  ExpectRefused("c.xml", LandXml(""), "holds no CgPoint");
  ExpectRefused("c.xml", LandXml("<CgPoint name=\"K\">1 2</CgPoint>", "<Metric linearUnit=\"cubit\"/>"),
                "is not known");
  ExpectRefused("c.xml", LandXml("<CgPoint name=\"K\">1 2</CgPoint><CgPoint name=\"K\">1 3</CgPoint>"), "there twice");
  ExpectRefused("c.xml", LandXml("<CgPoint name=\"K\">5334000 690000</CgPoint>"),
                "in EPSG:25832, the site is in EPSG:25833", {.csv = {.crs = "EPSG:25833"}});
  ExpectRefused("c.xml", LandXml("<CgPoint name=\"K\">690000 5334000</CgPoint>"), "northing and easting look exchanged",
                {.csv = {.crs = "EPSG:25832"}});
  ExpectRefused("c.xml", "<kml/>", "<kml> is not control");
  ExpectRefused("c.doc", "", "control must be a .csv, .txt, .gkf, .dat or .xml file");
}

// Axes, band, units and the order of the unknowns of an adjustment by another program.
TEST_F(ControlSourceTest, GamaAdjustment) {
  const std::string text =
      "<gama-local-adjustment><description>two points</description>"
      "<network-general-parameters gama-local-version=\"2.11\" axes-xy=\"sw\" angles=\"left-handed\"/>"
      "<network-processing-summary><project-equations><equations>9</equations><unknowns>5</unknowns>"
      "<degrees-of-freedom>4</degrees-of-freedom><defect>0</defect></project-equations>"
      "<standard-deviation><apriori>10</apriori><aposteriori>8</aposteriori><used>aposteriori</used>"
      "<probability>0.95</probability></standard-deviation></network-processing-summary>"
      "<coordinates><fixed><point><id>F</id><x>0</x><y>0</y></point></fixed>"
      "<approximate><point><id>B</id><x>1</x><y>1</y></point></approximate>"
      "<adjusted><point><id>B</id><x>-10</x><y>-20</y></point><point><id>A</id><x>-30</x><y>-40</y></point></adjusted>"
      "<cov-mat><dim>5</dim><band>4</band>"
      "<flt>4</flt><flt>1</flt><flt>0.5</flt><flt>0.25</flt><flt>9</flt>"
      "<flt>5</flt><flt>0.125</flt><flt>0</flt><flt>9</flt><flt>6</flt><flt>2</flt><flt>9</flt><flt>7</flt><flt>9</flt>"
      "<flt>9</flt></cov-mat></coordinates></gama-local-adjustment>";
  const ControlSource source = Read("a.xml", text);
  ASSERT_EQ(source.control.points.size(), 3U);
  const survey::ControlPoint &a = source.control.points[0], &b = source.control.points[1];
  EXPECT_EQ(a.name, "A");
  EXPECT_EQ(a.position_in_site, Eigen::Vector2d(40, 30));  // x south, y west
  EXPECT_EQ(b.position_in_site, Eigen::Vector2d(20, 10));
  EXPECT_LT((b.covariance - 1e-6 * Eigen::Matrix2d{{5, 1}, {1, 4}}).norm(), 1e-18);
  EXPECT_LT((a.covariance - 1e-6 * Eigen::Matrix2d{{7, 2}, {2, 6}}).norm(), 1e-18);
  ASSERT_EQ(source.control.correlations.size(), 1U);
  // Rows: east, north of A; columns: east, north of B.
  EXPECT_LT((source.control.correlations[0].covariance - 1e-6 * Eigen::Matrix2d{{0, 0.25}, {0.125, 0.5}}).norm(),
            1e-18);
  EXPECT_EQ(source.num_default_sigmas, 1);  // the fixed point
  ASSERT_TRUE(source.control.adjustment.has_value());
  EXPECT_EQ(source.control.adjustment->software, "GNU Gama 2.11");
  EXPECT_NEAR(source.control.adjustment->chi_square, 0.64 * 4, 1e-12);
  EXPECT_TRUE(source.control.adjustment->ChiSquareHolds());
}

TEST_F(ControlSourceTest, NavVisAndBlanks) {
  const ControlSourceOptions navvis = {.csv = {.order = "navvis"}};
  const ControlSource source = Read("c.csv", "# site\nID,X,Y,Z\nP1, 10.5, 20.25, 3, 0.1, more\n\nP2,11,21,4\n", navvis);
  ASSERT_EQ(source.control.points.size(), 2U);
  EXPECT_EQ(source.control.points[0].position_in_site, Eigen::Vector2d(10.5, 20.25));
  EXPECT_EQ(source.control.points[0].elevation_m, 3.0);
  EXPECT_EQ(source.control.points[0].description, "");
  const ControlSource text = Read("c.txt", "P1 20.25\t10.5  3 a bolt in the floor\n", {.csv = {.order = "pnezd"}});
  EXPECT_EQ(text.control.points[0].position_in_site, Eigen::Vector2d(10.5, 20.25));
  EXPECT_EQ(text.control.points[0].description, "a bolt in the floor");
}

TEST_F(ControlSourceTest, Roles) {
  const auto read = [&](const std::string& text) {
    formats::WriteFileAtomically(scratch_ / "roles.csv", text);
    return formats::ReadRolesCsv(scratch_ / "roles.csv");
  };
  const auto rows = read("point,role,reason\nK1,check,\nK2,excluded,disturbed\n");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].role, survey::PointRole::kCheck);
  EXPECT_EQ(rows[1].reason, "disturbed");
  for (const std::string bad : {"K1,chek,\n", "K1,excluded,\n", "K1,check,\nK1,control,\n"}) {
    EXPECT_THROW(read("point,role,reason\n" + bad), formats::DataError) << bad;
  }
}

// UTM zone 32: 0.9996 on the central meridian (up to 100 m of base), 1 near 180 km from it; up a mountain it shrinks.
TEST(GridScaleTest, UtmAndHeight) {
  const formats::GridScale on_meridian = formats::GridScaleAt("EPSG:25832", {500000, 5334000}, 0.0);
  EXPECT_NEAR(on_meridian.projection, 0.9996, 1e-9);
  EXPECT_EQ(on_meridian.height, 1.0);
  // k = k0 (1 + (E')2 / (2 R2)) with E' = 180 km / k0, R = 6380.45 km at 48.2 degrees.
  EXPECT_NEAR(formats::GridScaleAt("EPSG:25832", {680000, 5334000}, 0.0).projection,
              0.9996 * (1 + 0.5 * std::pow(180000 / 0.9996 / 6380450, 2)), 2e-7);
  EXPECT_NEAR(formats::GridScaleAt("EPSG:25832", {500000, 5334000}, 638.045).height, 1 / 1.0001, 1e-8);
  // A low-distortion projection: scale one at the height of the site.
  const std::string ldp = "+proj=tmerc +lat_0=48 +lon_0=11.5 +k=1.00008 +x_0=10000 +y_0=20000 +ellps=GRS80 +units=m";
  EXPECT_NEAR(formats::GridScaleAt(ldp, {10000, 20000}, 510.6).Combined(), 1.0, 1e-7);
  EXPECT_THROW(formats::GridScaleAt("EPSG:4326", {11, 48}, 0), formats::UsageError);
}

TEST(SiteMetricTest, SaysGridOrGround) {
  const Eigen::Vector2d place(500000, 5334000);
  EXPECT_EQ(formats::MetricAt({.frame = {.crs = "EPSG:25832"}, .tied = true}, place).distances, "grid");
  EXPECT_EQ(formats::MetricAt({.frame = {}, .tied = true}, place).distances, "plane of the control");
  EXPECT_EQ(formats::MetricAt({.frame = {.crs = "EPSG:25832"}, .tied = false}, place).distances, "local");
  survey::ControlNetwork network{.frame = {.crs = "EPSG:25832"}};
  network.points.push_back({.name = "1", .position_in_site = place, .elevation_m = 638.045});
  const std::string sentence = formats::MetricSentence(network);
  // 0.9996 on the meridian, divided by 1.0001 at this height.
  EXPECT_NE(sentence.find("point scale 0.99960000"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("combined factor 0.999500"), std::string::npos) << sentence;
  network.points[0].elevation_m.reset();
  EXPECT_NE(formats::MetricSentence(network).find("needs heights"), std::string::npos);
  network.frame.crs.clear();
  EXPECT_NE(formats::MetricSentence(network).find("own plane"), std::string::npos);
}

}  // namespace
