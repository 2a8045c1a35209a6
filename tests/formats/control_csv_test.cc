// SPDX-License-Identifier: Apache-2.0
#include "formats/control_csv.h"

#include <gtest/gtest.h>

#include <fstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "survey/stats/philox.h"
#include "tests/support/scratch_folder.h"

namespace {

using formats::ControlCsv;
using formats::ControlCsvOptions;
using survey::PointRole;

class ControlCsvTest : public testing::Test {
 protected:
  ControlCsv Read(const std::string& text, const ControlCsvOptions& options = {}) {
    formats::WriteFileAtomically(scratch_ / "points.csv", text);
    return formats::ReadControlCsv(scratch_ / "points.csv", options);
  }
  // The message of the refusal, without the folder.
  std::string Refusal(const std::string& text, const ControlCsvOptions& options = {}) {
    try {
      Read(text, options);
    } catch (const formats::DataError& error) {
      const std::string message = error.what();
      return message.substr(message.find("points.csv"));
    }
    return "accepted";
  }
  void ExpectRefused(const std::string& text, const std::string& words, const ControlCsvOptions& options = {}) {
    EXPECT_NE(Refusal(text, options).find(words), std::string::npos) << Refusal(text, options);
  }
  test_support::ScratchFolder scratch_;
};

TEST_F(ControlCsvTest, ReadsNamedColumnsInAnyOrder) {
  const ControlCsv csv = Read(
      "\xEF\xBB\xBF# surveyed twice\r\n"
      "sigma_e,point,Easting,northing,sigma_n,elevation,description,role,reason,cov_en\r\n"
      "0.003,K2,20.5,-10.25,0.002,101.5,\"nail, north\",check,,1e-6\r\n"
      "\r\n"
      "0.001,K1,+2,1,0.001,,,,,\r\n"
      "0.001,K3,2,1,0.001,,,Excluded,disturbed,\r\n");
  ASSERT_EQ(csv.points.size(), 3U);
  EXPECT_EQ(csv.points[0].name, "K1");
  EXPECT_EQ(csv.points[0].role, PointRole::kControl);
  EXPECT_FALSE(csv.points[0].elevation_m.has_value());
  const survey::ControlPoint& k2 = csv.points[1];
  EXPECT_EQ(k2.position_in_site, Eigen::Vector2d(20.5, -10.25));
  EXPECT_DOUBLE_EQ(k2.covariance(0, 0), 0.003 * 0.003);
  EXPECT_DOUBLE_EQ(k2.covariance(1, 1), 0.002 * 0.002);
  EXPECT_DOUBLE_EQ(k2.covariance(0, 1), 1e-6);
  EXPECT_EQ(k2.elevation_m, 101.5);
  EXPECT_EQ(k2.description, "nail, north");
  EXPECT_EQ(k2.role, PointRole::kCheck);
  EXPECT_EQ(csv.points[2].role, PointRole::kExcluded);
  EXPECT_EQ(csv.points[2].reason, "disturbed");
  EXPECT_EQ(csv.num_default_sigmas, 0);
  EXPECT_TRUE(csv.warnings.empty());
}

TEST_F(ControlCsvTest, ReadsBothOrdersWithoutHeader) {
  const std::string text = "1,5334000.5,690000.25,510,bolt\n2,5334010,690010\n";
  const ControlCsv pnezd = Read(text, {.order = "pnezd", .default_sigma_m = 0.004, .crs = "EPSG:25832"});
  EXPECT_EQ(pnezd.points[0].position_in_site, Eigen::Vector2d(690000.25, 5334000.5));
  EXPECT_EQ(pnezd.points[0].elevation_m, 510.0);
  EXPECT_EQ(pnezd.points[0].description, "bolt");
  EXPECT_DOUBLE_EQ(pnezd.points[1].covariance(1, 1), 0.004 * 0.004);
  EXPECT_EQ(pnezd.num_default_sigmas, 2);
  const ControlCsv penzd = Read(text, {.order = "penzd"});
  EXPECT_EQ(penzd.points[0].position_in_site, Eigen::Vector2d(5334000.5, 690000.25));
}

TEST_F(ControlCsvTest, NeverGuessesTheOrder) {
  const std::string refusal = Refusal("# c\nC1,100.5,200.25,3,x\n");
  EXPECT_EQ(refusal,
            "points.csv:2: the file has no header, so the order of the coordinates must be told: point C1 has northing "
            "100.5, easting 200.25 with control-order = \"pnezd\", or easting 100.5, northing 200.25 with "
            "control-order = \"penzd\"");
}

TEST_F(ControlCsvTest, FindsExchangedAxesByTheAreaOfUse) {
  const ControlCsvOptions options = {.crs = "EPSG:25832"};
  EXPECT_NO_THROW(Read("point,northing,easting\nC1,5334000,690000\n", options));
  const std::string refusal = Refusal("point,northing,easting\nC1,690000,5334000\n", options);
  EXPECT_NE(refusal.find("points.csv:2: point C1: northing and easting look exchanged"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("northing 690000, easting 5334000 lies outside"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("northing 5334000, easting 690000 lies inside"), std::string::npos) << refusal;
  // Neither reading fits: a local grid under a wrong CRS. Told, not refused.
  EXPECT_EQ(Read("point,northing,easting\nC1,10,20\n", options).warnings.size(), 1U);
  EXPECT_THROW(Read("point,northing,easting\nC1,10,20\n", {.crs = "EPSG:999999"}), formats::UsageError);
  EXPECT_THROW(Read("point,northing,easting\nC1,10,20\n", {.crs = "EPSG:4326"}), formats::UsageError);
}

TEST_F(ControlCsvTest, NamesRowFieldValueAndRule) {
  const std::string header = "point,northing,easting,sigma_n,sigma_e\n";
  ExpectRefused(header + "C1,1,2,0.01\n", "points.csv:2: 4 fields, expected 5 as in the header");
  ExpectRefused(header + "C1,,2,0.01,0.01\n", "points.csv:2: northing is missing (point C1)");
  ExpectRefused(header + "C1,1,2,0.01,\n", "points.csv:2: sigma_e is missing");
  ExpectRefused(header + ",1,2,0.01,0.01\n", "points.csv:2: point is missing");
  ExpectRefused(header + "C1,nan,2,0.01,0.01\n", "northing = \"nan\": ");
  ExpectRefused(header + "C1,1,inf,0.01,0.01\n", "easting = \"inf\": ");
  ExpectRefused(header + "C1,1,two,0.01,0.01\n", "easting = \"two\": is not a number");
  ExpectRefused(header + "C1,1,2,-0.002,0.01\n", "points.csv:2: sigma_n = -0.002: a sigma must be positive");
  ExpectRefused(header + "C1,1,2,0.002,0\n", "sigma_e = 0: a sigma must be positive");
  ExpectRefused(header + "C1,1,2,25,3\n", "sigma_n = 25: a sigma of more than 10 m");
  ExpectRefused("point,northing,easting,sigma_n,sigma_e,cov_en\nC1,1,2,0.1,0.1,0.02\n", "cov_en = 0.02: must be");
  ExpectRefused("point,northing,easting,sigma_n\nC1,1,2,1\n", "sigma_n and sigma_e must come together");
  ExpectRefused("point,northing,east\nC1,1,2\n", "unknown column \"east\"");
  ExpectRefused("point,northing,northing\nC1,1,2\n", "column \"northing\" appears twice");
  ExpectRefused("point,northing,description\nC1,1,2\n", "column \"easting\" is missing");
  ExpectRefused("", "holds no points");
  ExpectRefused(header, "holds a header but no points");
  ExpectRefused("C1,1,2,\"open\n", "a quoted field is not closed");
}

TEST_F(ControlCsvTest, HintsAtDecimalCommas) {
  ExpectRefused("point;northing;easting\n", "separated by commas");
  ExpectRefused("point,northing,easting\nC1,\"1,5\",2\n", "northing = \"1,5\": decimal comma");
  ExpectRefused("C1,100,25,200,50,3,00,bolt\n", "numbers need a decimal point", {.order = "pnezd"});
}

TEST_F(ControlCsvTest, RolesAreFewAndExclusionNeedsAReason) {
  const std::string header = "point,northing,easting,role,reason\n";
  ExpectRefused(header + "C1,1,2,chek,\n", "role = \"chek\": must be control, check, tie or excluded");
  ExpectRefused(header + "C1,1,2,excluded,\n", "points.csv:2: point C1 is excluded without a reason");
  EXPECT_EQ(Read(header + "T1,,,tie,\n").points[0].role, PointRole::kTie);
  ExpectRefused(header + "C1,,,check,\n", "easting is missing");
}

TEST_F(ControlCsvTest, RepeatedPoints) {
  const std::string header = "point,northing,easting,role\n";
  const ControlCsv same = Read(header + "C1,1,2,\nC1,1,2,control\n");
  EXPECT_EQ(same.points.size(), 1U);
  ASSERT_EQ(same.warnings.size(), 1U);
  EXPECT_NE(same.warnings[0].find("already in row 2"), std::string::npos);
  ExpectRefused(header + "C1,1,2,\nC1,1,2.5,\n",
                "points.csv:3: point C1 is already in row 2 with other coordinates: there northing 1, easting 2, here "
                "northing 1, easting 2.5");
  ExpectRefused(header + "C1,1,2,control\nC1,1,2,check\n", "as control, here it is check: a point has one role");
}

// Whatever is wrong with a file, it is the file's fault and said so.
TEST_F(ControlCsvTest, DamagedFilesAreRefusedOrRead) {
  const std::string whole =
      "# list\npoint,northing,easting,elevation,sigma_n,sigma_e,description,role,reason\n"
      "C1,5334000.5,690000.25,510,0.002,0.002,\"a "
      "\"\"bolt\"\"\",control,\nX,5334010,690010,,1e-3,2e-3,,excluded,lost\n";
  const survey::RandomStream random(5, 0, 0);
  int read = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    std::string text = whole;
    for (std::uint64_t k = 0; k < 3; ++k) {
      const auto bits = random.Bits(3 * i + k);
      const std::size_t at = bits[0] % text.size();
      if (bits[1] % 4 == 0) text.resize(at + 1);
      text[at] = bits[1] % 3 == 0 ? ",\"\n#;.-e"[bits[2] % 8] : static_cast<char>(bits[2]);
    }
    try {
      std::ofstream(scratch_ / "points.csv", std::ios::binary) << text;
      formats::ReadControlCsv(scratch_ / "points.csv", {.order = "pnezd"});
      ++read;
    } catch (const formats::DataError& error) {
      EXPECT_NE(std::string(error.what()).find("points.csv"), std::string::npos);
    }
  }
  EXPECT_GT(read, 0);
}

// Before it is held: a point cloud of a gigabyte that was taken for the list.
TEST_F(ControlCsvTest, AFileOfTooManyRowsIsRefusedWhereItBecomesTooLong) {
  std::string text;
  for (int i = 0; i < 200'001; ++i) text += std::to_string(i) + ",1,2\n";
  EXPECT_EQ(Refusal(text + "not, read\n", {.order = "pnezd"}),
            "points.csv:200001: more than 200000 rows: no control is so long (a point cloud?)");
}

TEST_F(ControlCsvTest, AcceptsOtherEncodings) {
  const ControlCsv latin = Read("point,northing,easting,description\nC1,1,2,T\xFCr\n");
  EXPECT_EQ(latin.points[0].description, "T\xC3\xBCr");
  EXPECT_EQ(latin.warnings.size(), 1U);
  ExpectRefused(std::string("\xFF\xFEp\0o\0", 6), "is UTF-16 text");
}

}  // namespace
