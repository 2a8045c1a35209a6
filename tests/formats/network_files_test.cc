// SPDX-License-Identifier: Apache-2.0
//
// Readers of observation files: axes and hands, units, encodings, and what they refuse.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "formats/angle_text.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/network_cluster.h"
#include "formats/network_file.h"
#include "survey/network/adjustment.h"
#include "survey/network/approximations.h"
#include "tests/support/scratch_folder.h"

namespace {

using formats::NetworkFile;
using survey::CoordinateUse;
using survey::ObservationKind;

class NetworkFilesTest : public testing::Test {
 protected:
  NetworkFile Gkf(const std::string& text) {
    formats::WriteFileAtomically(scratch_ / "n.gkf", text);
    return formats::ReadGkf(scratch_ / "n.gkf");
  }
  NetworkFile Starnet(const std::string& text, const formats::StarnetSigmas& sigmas = {0.002, 0, 5, 5, 5, 0.002}) {
    formats::WriteFileAtomically(scratch_ / "n.dat", text);
    return formats::ReadStarnet(scratch_ / "n.dat", sigmas);
  }
  template <typename Function>
  void ExpectRefused(Function read, const std::string& words) {
    try {
      read();
      ADD_FAILURE() << "accepted; expected: " << words;
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
  void ExpectGkfRefused(const std::string& text, const std::string& words) {
    ExpectRefused([&] { Gkf(text); }, words);
  }
  void ExpectStarnetRefused(const std::string& text, const std::string& words,
                            const formats::StarnetSigmas& sigmas = {0.002, 0, 5, 5, 5, 0.002}) {
    ExpectRefused([&] { Starnet(text, sigmas); }, words);
  }
  test_support::ScratchFolder scratch_;
};

std::string Network(const std::string& inside, const std::string& attributes = "") {
  return "<?xml version=\"1.0\"?>\n<gama-local xmlns=\"http://www.gnu.org/software/gama/gama-local\">\n<network " +
         attributes + ">\n<points-observations distance-stdev=\"2\" direction-stdev=\"10\">\n" + inside +
         "</points-observations></network></gama-local>\n";
}

std::string Num(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10f", value);
  return text;
}

// A point P seen from A and B, written with x and y in any of the eight pairs of directions and angles of either hand,
// always lies at the same place.
TEST_F(NetworkFilesTest, EveryPairOfAxesAndEitherHand) {
  const Eigen::Vector2d a(1000, 2000), b(1100, 2000), p(1040, 2070);
  const auto along = [](char axis, const Eigen::Vector2d& q) {
    return axis == 'e' ? q.x() : axis == 'w' ? -q.x() : axis == 'n' ? q.y() : -q.y();
  };
  const auto azimuth = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return std::atan2(to.x() - from.x(), to.y() - from.y()) / formats::kRadPerGon;
  };
  for (const std::string axes : {"ne", "sw", "es", "wn", "en", "nw", "se", "ws"}) {
    for (const std::string angles : {"left-handed", "right-handed"}) {
      SCOPED_TRACE(axes + " " + angles);
      const double hand = angles == "left-handed" ? 1.0 : -1.0;
      const auto fixed = [&](const std::string& id, const Eigen::Vector2d& q) {
        return "<point id='" + id + "' x='" + Num(along(axes[0], q)) + "' y='" + Num(along(axes[1], q)) +
               "' fix='xy'/>\n";
      };
      const auto direction = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, const std::string& name) {
        return "<direction to='" + name + "' val='" + Num(hand * (azimuth(from, to) - 33.0)) + "'/>\n";
      };
      NetworkFile file = Gkf(Network(fixed("A", a) + fixed("B", b) + "<point id='P' adj='xy'/>\n<obs from='A'>\n" +
                                         direction(a, b, "B") + direction(a, p, "P") + "</obs><obs from='B'>\n" +
                                         direction(b, a, "A") + direction(b, p, "P") + "<distance to='P' val='" +
                                         Num((p - b).norm()) + "'/></obs>\n",
                                     "axes-xy='" + axes + "' angles='" + angles + "'"));
      ASSERT_TRUE(ComputeApproximations(&file.network).empty());
      const survey::NetworkAdjustment adjustment = AdjustNetwork(file.network);
      ASSERT_TRUE(adjustment.usable) << adjustment.message;
      EXPECT_LT((adjustment.points[2].position.head<2>() - p).norm(), 1e-6);
      EXPECT_LT(adjustment.chi_square, 1e-6);
    }
  }
}

TEST_F(NetworkFilesTest, GkfUnitsAndDefaults) {
  const NetworkFile file =
      Gkf("<gama-local><network><parameters sigma-apr='5' conf-pr='0.9' sigma-act='apriori'/>\n"
          "<points-observations distance-stdev='3 2 1' zenith-angle-stdev='20'>\n"
          "<point id='A' x='0' y='0' z='0' fix='xyz'/><point id='B' x='1000' y='0' z='1' adj='XYz'/>\n"
          "<obs from='A' from_dh='1.5'><distance to='B' val='1000'/><z-angle to='B' val='90-00-30' to_dh='2'/></obs>\n"
          "<height-differences><dh from='A' to='B' val='1' dist='4'/></height-differences>\n"
          "</points-observations></network></gama-local>");
  const survey::Network& network = file.network;
  EXPECT_EQ(network.sigma_zero, 5.0);
  EXPECT_EQ(network.confidence, 0.9);
  EXPECT_FALSE(network.use_sigma_a_posteriori);
  EXPECT_EQ(network.points[1].plane, CoordinateUse::kConstrained);
  EXPECT_EQ(network.points[1].height, CoordinateUse::kAdjusted);
  EXPECT_EQ(network.points[1].position, Eigen::Vector3d(0, 1000, 1));  // x is north
  ASSERT_EQ(network.observations.size(), 3U);
  EXPECT_DOUBLE_EQ(network.observations[0].sigma, 0.005);  // 3 mm + 2 ppm
  EXPECT_DOUBLE_EQ(network.observations[1].value, M_PI / 2 + 30 * M_PI / 648000);
  EXPECT_DOUBLE_EQ(network.observations[1].sigma, 20 * M_PI / 648000);  // beside d-m-s: seconds
  EXPECT_EQ(network.observations[1].instrument_height, 1.5);
  EXPECT_EQ(network.observations[1].target_height, 2.0);
  EXPECT_DOUBLE_EQ(network.observations[2].sigma, 0.010);  // sigma zero times the root of 4 km
  EXPECT_EQ(file.angle_unit, formats::AngleUnit::kDegrees);
}

TEST_F(NetworkFilesTest, EntitiesAreRefused) {
  ExpectGkfRefused("<!DOCTYPE g [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;\">]>\n<gama-local>&b;</gama-local>",
                   "n.gkf:1: declares the entity \"a\": entity declarations are refused");
  ExpectGkfRefused("<!DOCTYPE g [<!ENTITY x SYSTEM \"file:///etc/hostname\">]>\n<gama-local>&x;</gama-local>",
                   "entity declarations are refused");
  // A document type without entities is harmless, and nothing is fetched.
  EXPECT_NO_THROW(Gkf("<!DOCTYPE gama-xml SYSTEM \"gama-xml.dtd\">\n<gama-xml><network></network></gama-xml>"));
}

TEST_F(NetworkFilesTest, Encodings) {
  const std::string inside = "<point id='T\xFCr' x='1' y='2' fix='xy'/>\n";
  const NetworkFile undeclared = Gkf(Network(inside));
  EXPECT_EQ(undeclared.network.points[0].name, "T\xC3\xBCr");
  EXPECT_EQ(undeclared.warnings.size(), 1U);
  EXPECT_EQ(Gkf("<?xml version='1.0' encoding='windows-1252'?><gama-local><network><points-observations>" + inside +
                "</points-observations></network></gama-local>")
                .network.points[0]
                .name,
            "T\xC3\xBCr");
  std::string utf16 = "\xFF\xFE";
  for (const char c : Network("<point id='A' x='1' y='2' fix='xy'/>")) utf16 += {c, '\0'};
  EXPECT_EQ(Gkf(utf16).network.points.size(), 1U);
  EXPECT_EQ(Gkf("\xEF\xBB\xBF<gama-local><network/></gama-local>").network.points.size(), 0U);
}

TEST_F(NetworkFilesTest, GkfNamesLineValueAndRule) {
  const std::string points = "<point id='A' x='0' y='0' fix='xy'/>\n<point id='B' adj='xy'/>\n";
  const auto refused = [&](const std::string& obs, const std::string& words) {
    ExpectGkfRefused(Network(points + obs), words);
  };
  refused("<obs from='A'><distance to='B' val='10,5'/></obs>",
          "n.gkf:7: <distance>: val = \"10,5\": decimal comma: write numbers with a decimal point");
  refused("<obs from='A'><distance to='B' val='-5'/></obs>", "val = -5: a distance must be positive");
  refused("<obs from='A'><distance to='B' val='5' stdev='0'/></obs>",
          "stdev = 0: a standard deviation must be positive");
  refused("<obs from='A'><distance to='B' val='5' stdv='2'/></obs>", "unknown attribute stdv");
  refused("<obs from='A'><azimuth to='B' val='5'/></obs>", "the azimuth has no standard deviation");
  refused("<obs from='A'><direction to='B' val='1-70-00'/></obs>", "must be gon (123.4567) or degrees (123-45-06.7)");
  refused("<obs from='A'><direction to='A' val='1'/></obs>", "is observed from itself");
  refused("<obs from='A'><distance val='5'/></obs>", "attribute to is missing");
  refused("<obs><distance to='B' val='5'/></obs>", "attribute from is missing");
  refused("<obs from='A'><range to='B' val='5'/></obs>", "<range>: unknown element");
  refused("<point id='A' x='1' y='0' fix='xy'/>", "point A is already there");
  refused("<obs from='A'><distance to='B' val='5'/><cov-mat dim='2' band='0'>1 1</cov-mat></obs>",
          "the covariance matrix has the dimension 2 for 1 observations");
  refused(
      "<obs from='A'><distance to='B' val='5'/><distance to='B' val='5'/><cov-mat dim='2' band='1'>1 2 "
      "1</cov-mat></obs>",
      "is not positive definite");
  refused("<obs from='A'><distance to='B' val='5'/><cov-mat dim='1' band='0'>1 1</cov-mat></obs>", "too many numbers");
  ExpectGkfRefused(Network("", "axes-xy='nn'"), "axes-xy = \"nn\": must be one of");
  ExpectGkfRefused(Network("<point id='A' x='0' y='0' fix='xq'/>"), "must be made of x, y and z");
  ExpectGkfRefused(Network("<point id='A' fix='xy'/>"), "point A is fixed but has no coordinates");
  ExpectGkfRefused("<gama-local><network>", "is not well-formed XML");
  ExpectGkfRefused("<kml/>", "is no GNU Gama network");
  ExpectGkfRefused("", "is not well-formed XML");
}

TEST_F(NetworkFilesTest, ObservationsOfUnknownPointsAreToldNotTaken) {
  const NetworkFile file =
      Gkf(Network("<point id='A' x='0' y='0' fix='xy'/>\n<point id='B' adj='xy'/>\n"
                  "<obs from='A'><distance to='B' val='5'/><distance to='b' val='5'/></obs>"));
  EXPECT_EQ(file.network.observations.size(), 1U);
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_NE(file.warnings[0].find("n.gkf:7: distance A - b: left out"), std::string::npos) << file.warnings[0];
}

// ------------------------------------------------------------------------------------------------------------ STAR*NET

const std::string kHead = ".UNITS METERS\n.2D\n.ORDER NE\n";

TEST_F(NetworkFilesTest, StarnetReadsTraversesSetsAndBearings) {
  const NetworkFile file = Starnet(
      ".UNITS METERS DMS\n.3D\n.ORDER NE ATFROMTO\n"
      "C A 100 200 10 ! ! ! 'nail\n"
      "C B 150 200 11 0.01 & *   # 1 cm in north\n"
      "TB B\nT A 90-00-00 50.00 89-30-00 1.5/1.6\nT C 180-30-00 60 90-00-00 3 0.004 &\nTE D\n"
      "DB A\nDN B 0-00-00\nDM C 90-00-01 50.01 89-30-01 2 0.003 8\nDE\n"
      "B A-B N00-00-00E\nBM A-C S45-30-00W 12 90-00-00\nL A-B 1.001 0.25\n");
  const survey::Network& n = file.network;
  EXPECT_EQ(n.points[0].plane, CoordinateUse::kFixed);
  EXPECT_EQ(n.points[1].plane, CoordinateUse::kAdjusted);
  EXPECT_EQ(n.points[1].position, Eigen::Vector3d(200, 150, 11));
  std::vector<ObservationKind> kinds;
  for (const survey::Observation& o : n.observations) kinds.push_back(o.kind);
  using enum ObservationKind;
  EXPECT_EQ(kinds,
            (std::vector<ObservationKind>{kCoordinate, kAngle, kSlopeDistance, kZenithAngle, kAngle, kSlopeDistance,
                                          kZenithAngle, kDirection, kDirection, kSlopeDistance, kZenithAngle, kAzimuth,
                                          kAzimuth, kSlopeDistance, kZenithAngle, kHeightDifference}));
  EXPECT_EQ(n.observations[0].component, 1);
  EXPECT_EQ(n.observations[0].sigma, 0.01);
  const survey::Observation& first_leg = n.observations[1];
  EXPECT_EQ(n.points[static_cast<std::size_t>(first_leg.from)].name, "A");
  EXPECT_EQ(n.points[static_cast<std::size_t>(first_leg.to)].name, "B");
  EXPECT_EQ(n.points[static_cast<std::size_t>(first_leg.fore)].name, "C");
  EXPECT_EQ(n.observations[2].instrument_height, 1.5);
  EXPECT_EQ(n.observations[2].target_height, 1.6);
  EXPECT_DOUBLE_EQ(n.observations[4].sigma, 3 * M_PI / 648000);
  EXPECT_EQ(n.observations[5].sigma, 0.004);
  EXPECT_DOUBLE_EQ(n.observations[6].sigma, 5 * M_PI / 648000);  // & is the default
  EXPECT_EQ(n.num_sets, 1);
  EXPECT_NEAR(n.observations[12].value, 225.5 * M_PI / 180, 1e-12);
  EXPECT_DOUBLE_EQ(n.observations[15].sigma, 0.001);  // 2 mm times the root of 0.25 km
}

TEST_F(NetworkFilesTest, StarnetFeet) {
  const NetworkFile file = Starnet(".UNITS USFEET\n.2D\n.ORDER EN\nC A 3937 0 ! !\nC B 0 0\nD A-B 3937 0.01\n");
  EXPECT_NEAR(file.network.points[0].position.x(), 1200.0, 1e-9);
  EXPECT_NEAR(file.network.observations[0].value, 1200.0, 1e-9);
  EXPECT_NEAR(file.network.observations[0].sigma, 0.01 * 1200 / 3937, 1e-12);
}

TEST_F(NetworkFilesTest, StarnetGuessesNothing) {
  ExpectStarnetRefused(".2D\n.ORDER NE\nC A 1 2 ! !\n", "n.dat:3: the file must state its unit of length");
  ExpectStarnetRefused(".UNITS METERS\n.ORDER NE\nC A 1 2 ! !\n", "must state .2D or .3D");
  ExpectStarnetRefused(".UNITS METERS\n.2D\nC A 1 2 ! !\n",
                       "station A has north 1, east 2 with .ORDER NE, or north 2, east 1 with .ORDER EN");
  ExpectStarnetRefused(kHead + "D A-B 10\n", "has no standard deviation, and the option starnet-distance-sigma-m", {});
  ExpectStarnetRefused(".UNITS GONS\n", "unit \"GONS\": must be METERS");
  ExpectStarnetRefused(".SCALE 1.0\n", "the inline option .SCALE is not known here");
}

TEST_F(NetworkFilesTest, StarnetNamesLineValueAndRule) {
  ExpectStarnetRefused(kHead + "D A-B 10,5\n", "n.dat:4: the distance = \"10,5\": decimal comma");
  ExpectStarnetRefused(kHead + "D A-B 10 -1\n", "standard deviation = -1: must be positive");
  ExpectStarnetRefused(kHead + "D A-B-C 10\n", "expected 2 station names");
  ExpectStarnetRefused(kHead + "A A-B-C 12.3456\n", "must be degrees-minutes-seconds");
  ExpectStarnetRefused(kHead + "A A-B-C 12-61-00\n", "must be degrees-minutes-seconds");
  ExpectStarnetRefused(kHead + "D A-B 10 0.01 7\n", "\"7\" is one value too many");
  ExpectStarnetRefused(kHead + "G0 A-B 10\n", "lines of type G0 are not known here");
  ExpectStarnetRefused(kHead + "DB A\nDN B 0-00-00\n", "is not ended by DE");
  ExpectStarnetRefused(kHead + "DB A\nD A-B 10\n", "lines of type D have no place in a direction set");
  ExpectStarnetRefused(kHead + "C A 1 2 ! *\n", "north and east must both be fixed");
  ExpectStarnetRefused(kHead + "C A 1 2\nC A 1 2\n", "station A has coordinates already");
  ExpectStarnetRefused(kHead + "L A-B 1\n", "need .3D");
}

// Before they are held: gigabytes of something else that was taken for a network.
TEST(NetworkClustersTest, TooLongANetworkIsRefusedWhereItBecomesTooLong) {
  const auto refusal = [](const std::function<void(formats::NetworkClusters*, int)>& add) -> std::string {
    formats::NetworkClusters clusters;
    for (int i = 0; i < 1'000'002; ++i) {
      try {
        add(&clusters, i);
      } catch (const formats::DataError& error) {
        return error.what();
      }
    }
    return "";
  };
  EXPECT_EQ(refusal([](formats::NetworkClusters* clusters, int i) {
              clusters->AddPoint({.name = std::to_string(i)}, "a.gkf:" + std::to_string(i + 1) + ": ");
            }),
            "a.gkf:200001: more than 200000 points: no control is so long (a point cloud?)");
  EXPECT_EQ(refusal([](formats::NetworkClusters* clusters, int i) {
              clusters->Add({.from = "A", .to = "B"}, "a.gkf:" + std::to_string(i + 1) + ": ");
            }),
            "a.gkf:1000001: more than 1000000 observations: no control is so long (a point cloud?)");
}

TEST(AngleTextTest, DegreesMinutesSeconds) {
  EXPECT_NEAR(*formats::ParseDms("1-30-36"), 1.51 * M_PI / 180, 1e-15);
  EXPECT_NEAR(*formats::ParseDms("-0-00-10"), -10 * M_PI / 648000, 1e-18);
  EXPECT_FALSE(formats::ParseDms("12.5"));
  EXPECT_FALSE(formats::ParseDms("12.5-10"));
  EXPECT_FALSE(formats::ParseDms("1-2-3-4"));
  EXPECT_FALSE(formats::ParseDms("1-60"));
  EXPECT_FALSE(formats::ParseDms(""));
  EXPECT_EQ(formats::DmsText(59.999999999 / 60 * M_PI / 180, 2), "1-00-00.00");
  EXPECT_EQ(formats::DmsText(-1.51 * M_PI / 180, 0), "-1-30-36");
  EXPECT_EQ(formats::GonText(M_PI / 2, 4), "100.0000");
}

}  // namespace
