// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_file.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/map_files.h"
#include "tests/support/command.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::SiteRaster;
using test_support::ScratchFolder;

// A room in UTM coordinates: walls round free space, one unknown corner. 700 x 600 cells.
SiteRaster Room() {
  SiteRaster raster{.cell_size_m = 0.05, .min_column = 10000001, .min_row = 112000003, .width = 700, .height = 600};
  raster.log_odds.assign(700 * 600, -2.0F);
  for (int c = 0; c < 700; ++c) raster.At(c, 0) = raster.At(c, 599) = 3.5F;
  for (int r = 0; r < 600; ++r) raster.At(0, r) = 3.5F;
  for (int r = 0; r < 100; ++r) {
    for (int c = 500; c < 700; ++c) raster.At(c, r) = survey::kUnknownLogOdds;
  }
  raster.At(3, 2) = 0.25F;
  return raster;
}

const RasterLabel kUtm{.frame = {.crs = "EPSG:25832", .wkt2 = ""}, .tied = true};

Provenance SomeProvenance() {
  return {.records = {{.stage = "grid",
                       .version = "1",
                       .options = {{"cell-size-m", "0.05"}},
                       .inputs = {{.role = "session", .sha256 = std::string(64, 'a')}}}}};
}

GDALDatasetUniquePtr Open(const fs::path& file) {
  GDALAllRegister();
  return GDALDatasetUniquePtr(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
}

void ExpectSame(const SiteRaster& a, const SiteRaster& b) {
  EXPECT_EQ(a.cell_size_m, b.cell_size_m);
  EXPECT_EQ(a.min_column, b.min_column);
  EXPECT_EQ(a.min_row, b.min_row);
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  for (std::size_t i = 0; i < a.log_odds.size(); ++i) {
    ASSERT_TRUE(a.log_odds[i] == b.log_odds[i] || (std::isnan(a.log_odds[i]) && std::isnan(b.log_odds[i]))) << i;
  }
}

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(RasterFile, ComesBackBitForBit) {
  const ScratchFolder scratch;
  WriteRaster(scratch / "grid.tif", Room(), kUtm, SomeProvenance());
  RasterLabel label;
  ExpectSame(ReadRaster(scratch / "grid.tif", &label), Room());
  EXPECT_TRUE(label.tied);
  EXPECT_EQ(label.frame.crs, "EPSG:25832");
  EXPECT_EQ(label.frame.wkt2, Wkt2OfCrs("EPSG:25832"));
}

SiteRaster RoomWithSigmas() {
  SiteRaster room = Room();
  room.sigma_m.assign(room.log_odds.size(), 0.0123F);
  room.sigma_m[room.Index(0, 599)] = 0.2F;  // the north-western corner
  room.sigma_m[room.Index(699, 0)] = std::numeric_limits<float>::quiet_NaN();
  return room;
}

TEST(RasterFile, TheUncertaintyIsASecondBand) {
  const ScratchFolder scratch;
  const SiteRaster room = RoomWithSigmas();
  WriteRaster(scratch / "grid.tif", room, kUtm, SomeProvenance());
  const SiteRaster read = ReadRaster(scratch / "grid.tif");
  ExpectSame(read, room);
  ASSERT_EQ(read.sigma_m.size(), room.sigma_m.size());
  EXPECT_EQ(read.sigma_m[room.Index(0, 599)], 0.2F);
  EXPECT_TRUE(std::isnan(read.sigma_m[room.Index(699, 0)]));

  WriteCogMap(scratch / "site.tif", room, kUtm, SomeProvenance());
  const auto data = Open(scratch / "site.tif");
  ASSERT_EQ(data->GetRasterCount(), 2);
  GDALRasterBand* band = data->GetRasterBand(2);
  EXPECT_DOUBLE_EQ(band->GetScale(), 0.002);
  std::uint8_t cells[2];
  ASSERT_EQ(band->RasterIO(GF_Read, 0, 0, 2, 1, cells, 2, 1, GDT_Byte, 0, 0, nullptr), CE_None);
  EXPECT_EQ(cells[0], 100);
  EXPECT_EQ(cells[1], 6);
  ASSERT_EQ(band->GetOverviewCount(), 1);
  ASSERT_EQ(band->GetOverview(0)->RasterIO(GF_Read, 0, 0, 1, 1, cells, 1, 1, GDT_Byte, 0, 0, nullptr), CE_None);
  EXPECT_EQ(cells[0], 100);  // the largest below
}

TEST(RasterFile, NegativeCellsComeBack) {
  const ScratchFolder scratch;
  SiteRaster raster{.cell_size_m = 0.1, .min_column = -37, .min_row = -1001, .width = 3, .height = 2};
  raster.log_odds = {1, 2, 3, 4, 5, 6};
  WriteRaster(scratch / "grid.tif", raster, {}, SomeProvenance());
  ExpectSame(ReadRaster(scratch / "grid.tif"), raster);
}

TEST(RasterFile, EqualInputsGiveEqualBytes) {
  const ScratchFolder scratch;
  for (const char* name : {"a", "b"}) {
    fs::create_directory(scratch / name);
    WriteRaster(scratch / name / "grid.tif", Room(), kUtm, SomeProvenance());
    WriteCogMap(scratch / name / "site.tif", Room(), kUtm, SomeProvenance());
    WritePngMap(scratch / name / "site.png", Room(), kUtm);
    WriteRosMap(scratch / name / "ros", Room(), kUtm);
  }
  // All in one pass as one by one.
  const SiteRaster room = Room();
  WriteRaster(scratch / "c/grid.tif", room, kUtm, SomeProvenance());
  WriteMapFiles({.tif = scratch / "c/site.tif", .png = scratch / "c/site.png", .ros = scratch / "c/ros"},
                survey::StripsOf(room), kUtm, SomeProvenance());
  for (const char* file : {"grid.tif", "site.tif", "site.png", "site.pgw", "site.png.aux.xml", "ros/map.yaml",
                           "ros/map_local.yaml", "ros/map.pgm"}) {
    EXPECT_TRUE(ReadWholeFile(scratch / "a" / file) == ReadWholeFile(scratch / "b" / file)) << file;
    EXPECT_TRUE(ReadWholeFile(scratch / "a" / file) == ReadWholeFile(scratch / "c" / file)) << file;
  }
  // Nothing else lies there: no sidecars, no temporaries.
  int files = 0;
  for ([[maybe_unused]] const auto& entry : fs::recursive_directory_iterator(scratch / "c")) ++files;
  EXPECT_EQ(files, 9);
}

TEST(RasterFile, CarriesItsProvenanceAndItsLabel) {
  const ScratchFolder scratch;
  WriteRaster(scratch / "grid.tif", Room(), kUtm, SomeProvenance());
  WriteCogMap(scratch / "local.tif", Room(), {}, SomeProvenance());
  const auto grid = Open(scratch / "grid.tif");
  EXPECT_EQ(ProvenanceFromJson(nlohmann::json::parse(grid->GetMetadataItem("PLUMBLINE_PROVENANCE"))).Own().Id(),
            SomeProvenance().Own().Id());
  EXPECT_STREQ(grid->GetMetadataItem("PLUMBLINE_TIED"), "yes");
  const auto local = Open(scratch / "local.tif");
  EXPECT_STREQ(local->GetMetadataItem("PLUMBLINE_TIED"), "no");
  EXPECT_STREQ(local->GetSpatialRef()->GetName(), "local frame of the block, not tied to control");
  EXPECT_TRUE(local->GetSpatialRef()->IsLocal());
}

TEST(RasterFile, WithoutCrsTheControlsPlaneIsAnEngineeringCrs) {
  const ScratchFolder scratch;
  WriteRaster(scratch / "grid.tif", Room(), {.frame = {}, .tied = true}, SomeProvenance());
  const auto data = Open(scratch / "grid.tif");
  EXPECT_STREQ(data->GetSpatialRef()->GetName(), "site plane of the control");
  EXPECT_TRUE(data->GetSpatialRef()->IsLocal());
  EXPECT_DOUBLE_EQ(data->GetSpatialRef()->GetLinearUnits(), 1.0);
}

TEST(CogMap, IsACloudOptimizedGeoTiffOnTheCellRaster) {
  const ScratchFolder scratch;
  WriteCogMap(scratch / "site.tif", Room(), kUtm, SomeProvenance());
  const auto data = Open(scratch / "site.tif");
  ASSERT_TRUE(data);
  EXPECT_STREQ(data->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
  EXPECT_STREQ(data->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
  EXPECT_STREQ(data->GetSpatialRef()->GetAuthorityCode(nullptr), "25832");
  double t[6];
  ASSERT_EQ(data->GetGeoTransform(t), CE_None);
  EXPECT_NEAR(t[0], 500000.05, 1e-9);
  EXPECT_NEAR(t[3], 5600000.15 + 600 * 0.05, 1e-8);
  EXPECT_DOUBLE_EQ(t[1], 0.05);
  EXPECT_DOUBLE_EQ(t[5], -0.05);
  int block_x = 0;
  int block_y = 0;
  GDALRasterBand* band = data->GetRasterBand(1);
  band->GetBlockSize(&block_x, &block_y);
  EXPECT_EQ(block_x, 512);
  EXPECT_EQ(block_y, 512);
  EXPECT_EQ(band->GetNoDataValue(), 255);
  std::uint8_t corner[4];  // north-west: wall, wall; wall, free
  ASSERT_EQ(band->RasterIO(GF_Read, 0, 0, 2, 2, corner, 2, 2, GDT_Byte, 0, 0, nullptr), CE_None);
  EXPECT_EQ(corner[0], 97);
  EXPECT_EQ(corner[3], 12);
  std::uint8_t unknown = 0;
  ASSERT_EQ(band->RasterIO(GF_Read, 699, 599, 1, 1, &unknown, 1, 1, GDT_Byte, 0, 0, nullptr), CE_None);
  EXPECT_EQ(unknown, 255);
}

TEST(CogMap, ThinWallsAndUnknownSurviveInTheOverviews) {
  const ScratchFolder scratch;
  WriteCogMap(scratch / "site.tif", Room(), kUtm, SomeProvenance());
  const auto data = Open(scratch / "site.tif");
  GDALRasterBand* band = data->GetRasterBand(1);
  ASSERT_EQ(band->GetOverviewCount(), 1);
  GDALRasterBand* overview = band->GetOverview(0);
  ASSERT_EQ(overview->GetXSize(), 350);
  ASSERT_EQ(overview->GetYSize(), 300);
  std::vector<std::uint8_t> cells(350 * 300);
  ASSERT_EQ(overview->RasterIO(GF_Read, 0, 0, 350, 300, cells.data(), 350, 300, GDT_Byte, 0, 0, nullptr), CE_None);
  for (int row = 0; row < 300; ++row) EXPECT_EQ(cells[static_cast<std::size_t>(row) * 350], 97) << row;
  EXPECT_EQ(cells[10 * 350 + 10], 12);
  EXPECT_EQ(cells[299 * 350 + 349], 255);
}

TEST(PngMap, TheWorldFileAgreesWithTheGeoTiff) {
  const ScratchFolder scratch;
  WriteCogMap(scratch / "site.tif", Room(), kUtm, SomeProvenance());
  WritePngMap(scratch / "site.png", Room(), kUtm);
  std::ifstream world(scratch / "site.pgw");
  double a = 0;
  double d = 0;
  double b = 0;
  double e = 0;
  double c = 0;
  double f = 0;
  ASSERT_TRUE(world >> a >> d >> b >> e >> c >> f);
  double t[6];
  Open(scratch / "site.tif")->GetGeoTransform(t);
  EXPECT_EQ(a, t[1]);
  EXPECT_EQ(e, t[5]);
  EXPECT_EQ(d, 0);
  EXPECT_EQ(b, 0);
  EXPECT_NEAR(c, t[0] + t[1] / 2, 1e-8);
  EXPECT_NEAR(f, t[3] + t[5] / 2, 1e-8);
}

TEST(PngMap, OpensInItsPlaceWithItsCrsAndGreys) {
  const ScratchFolder scratch;
  WritePngMap(scratch / "site.png", Room(), kUtm);
  const auto data = Open(scratch / "site.png");
  ASSERT_TRUE(data);
  ASSERT_NE(data->GetSpatialRef(), nullptr);
  EXPECT_STREQ(data->GetSpatialRef()->GetAuthorityCode(nullptr), "25832");
  double t[6];
  ASSERT_EQ(data->GetGeoTransform(t), CE_None);
  EXPECT_NEAR(t[0], 500000.05, 1e-7);
  EXPECT_NEAR(t[3], 5600030.15, 1e-7);
  const auto grey = [&](int column, int line) {
    std::uint8_t value = 0;
    EXPECT_EQ(data->GetRasterBand(1)->RasterIO(GF_Read, column, line, 1, 1, &value, 1, 1, GDT_Byte, 0, 0, nullptr),
              CE_None);
    return value;
  };
  EXPECT_EQ(grey(5, 0), 0);
  EXPECT_EQ(grey(5, 5), 255);
  EXPECT_EQ(grey(699, 599), 205);
}

TEST(PngMap, NotTiedIsWrittenBesideThePicture) {
  const ScratchFolder scratch;
  WritePngMap(scratch / "B1.png", Room(), {});
  const auto data = Open(scratch / "B1.png");
  ASSERT_NE(data->GetSpatialRef(), nullptr);
  EXPECT_STREQ(data->GetSpatialRef()->GetName(), "local frame of the block, not tied to control");
  EXPECT_STREQ(data->GetMetadataItem("PLUMBLINE_TIED"), "no");
}

std::map<std::string, std::string> ReadYaml(const fs::path& file) {
  std::map<std::string, std::string> values;
  std::istringstream text(ReadWholeFile(file));
  for (std::string line; std::getline(text, line);) {
    const std::size_t colon = line.find(": ");
    if (line[0] != '#' && colon != std::string::npos) values[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return values;
}

TEST(RosMap, ReadsBackAsMapServerDoes) {
  const ScratchFolder scratch;
  WriteRosMap(scratch.path(), Room(), kUtm);
  auto yaml = ReadYaml(scratch / "map.yaml");
  EXPECT_EQ(yaml["image"], "map.pgm");
  EXPECT_EQ(yaml["resolution"], "0.05");
  EXPECT_EQ(yaml["negate"], "0");
  EXPECT_EQ(yaml["origin"], "[500000.0500, 5600000.1500, 0.0]");
  EXPECT_EQ(ReadYaml(scratch / "map_local.yaml")["origin"], "[0.0000, 0.0000, 0.0]");
  EXPECT_NE(ReadWholeFile(scratch / "map_local.yaml").find("site = local + (500000.0500, 5600000.1500)"),
            std::string::npos);
  const double occupied = std::stod(yaml["occupied_thresh"]);
  const double free = std::stod(yaml["free_thresh"]);
  const auto data = Open(scratch / "map.pgm");
  ASSERT_TRUE(data);
  ASSERT_EQ(data->GetRasterYSize(), 600);
  const auto state = [&](int column, int line) {
    std::uint8_t value = 0;
    EXPECT_EQ(data->GetRasterBand(1)->RasterIO(GF_Read, column, line, 1, 1, &value, 1, 1, GDT_Byte, 0, 0, nullptr),
              CE_None);
    const double p = (255 - value) / 255.0;
    return p > occupied ? "occupied" : p < free ? "free" : "unknown";
  };
  EXPECT_STREQ(state(5, 0), "occupied");
  EXPECT_STREQ(state(5, 5), "free");
  EXPECT_STREQ(state(699, 599), "unknown");
}

TEST(Wkt2OfCrs, KnowsProjectedMetresOnly) {
  EXPECT_EQ(Wkt2OfCrs(""), "");
  EXPECT_TRUE(Wkt2OfCrs("EPSG:25832").starts_with("PROJCRS["));
  EXPECT_TRUE(Wkt2OfCrs("EPSG:31467").starts_with("PROJCRS["));  // Gauss-Krueger: northing first in its definition
  for (const char* crs : {"EPSG:4326", "EPSG:999999", "EPSG:2263", "EPSG:2065", "nonsense", "/etc/passwd"}) {
    EXPECT_THROW(Wkt2OfCrs(crs), UsageError) << crs;
    EXPECT_NE(MessageOf([&] { Wkt2OfCrs(crs); }).find(crs), std::string::npos);
  }
}

TEST(RasterFile, EastingStaysXWhereTheCrsNamesNorthingFirst) {
  const ScratchFolder scratch;
  const RasterLabel label{.frame = {.crs = "EPSG:31467", .wkt2 = ""}, .tied = true};
  WriteRaster(scratch / "grid.tif", Room(), label, SomeProvenance());
  ExpectSame(ReadRaster(scratch / "grid.tif"), Room());
  WritePngMap(scratch / "site.png", Room(), label);
  double t[6];
  Open(scratch / "site.png")->GetGeoTransform(t);
  EXPECT_NEAR(t[0], 500000.05, 1e-7);
}

TEST(RasterFile, DamagedAndForeignFilesAreNamed) {
  const ScratchFolder scratch;
  WriteRaster(scratch / "grid.tif", Room(), kUtm, SomeProvenance());
  const std::string whole = ReadWholeFile(scratch / "grid.tif");
  WriteFileAtomically(scratch / "half.tif", whole.substr(0, whole.size() / 2));
  WriteFileAtomically(scratch / "text.tif", "not a raster");
  WriteCogMap(scratch / "site.tif", Room(), kUtm, SomeProvenance());
  for (const char* name : {"half.tif", "text.tif", "site.tif", "missing.tif"}) {
    EXPECT_THROW(ReadRaster(scratch / name), DataError) << name;
    EXPECT_NE(MessageOf([&] { ReadRaster(scratch / name); }).find(name), std::string::npos) << name;
  }
}

TEST(RasterFile, AnEmptyRasterIsRefused) {
  const ScratchFolder scratch;
  EXPECT_THROW(WriteRaster(scratch / "grid.tif", SiteRaster{}, kUtm, SomeProvenance()), DataError);
  EXPECT_THROW(WriteCogMap(scratch / "site.tif", SiteRaster{}, kUtm, SomeProvenance()), DataError);
  EXPECT_THROW(WritePngMap(scratch / "site.png", SiteRaster{}, kUtm), DataError);
}

// A limit on the size of files stands for the full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit old_{};
  void (*handler_)(int) = nullptr;
};

TEST(RasterFile, AFullDiskLeavesTheOldFile) {
  const ScratchFolder scratch;
  SiteRaster small = Room();
  SiteRaster noisy = Room();
  for (std::size_t i = 0; i < noisy.log_odds.size(); ++i) {
    noisy.log_odds[i] = static_cast<float>(std::sin(static_cast<double>(i * i)));
  }
  for (const char* name : {"grid.tif", "site.tif", "site.png"}) {
    const fs::path file = scratch / name;
    const auto write = [&](const SiteRaster& raster) {
      if (file == scratch / "grid.tif") return WriteRaster(file, raster, kUtm, SomeProvenance());
      if (file == scratch / "site.tif") return WriteCogMap(file, raster, kUtm, SomeProvenance());
      WritePngMap(file, raster, kUtm);
    };
    write(small);
    const std::string before = ReadWholeFile(file);
    std::string message;
    {
      const FileSizeLimit limit(20000);
      message = MessageOf([&] { write(noisy); });
    }
    EXPECT_NE(message.find(name), std::string::npos) << name << ": " << message;
    EXPECT_TRUE(ReadWholeFile(file) == before) << name;
  }
  for (const auto& entry : fs::directory_iterator(scratch.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".tmp-")) << entry.path();
  }
}

TEST(RasterFile, GdalinfoSaysTheSame) {
  if (test_support::RunCommand({"gdalinfo", "--version"}).status != 0) GTEST_SKIP() << "gdalinfo is not installed";
  const ScratchFolder scratch;
  WriteCogMap(scratch / "site.tif", Room(), kUtm, SomeProvenance());
  const auto result = test_support::RunCommand({"gdalinfo", (scratch / "site.tif").string()});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  for (const char* text :
       {"ID[\"EPSG\",25832]", "Origin = (500000.05000000", "Pixel Size = (0.05", "LAYOUT=COG", "NoData Value=255",
        "PLUMBLINE_TIED=yes", "PLUMBLINE_DISTANCES=grid", "PLUMBLINE_POINT_SCALE=0.99960000",
        "PLUMBLINE_METRIC=grid distances, metres; ground = grid / (0.99960000 R / (R + h))"}) {
    EXPECT_NE(result.out.find(text), std::string::npos) << text << "\n" << result.out;
  }
}

}  // namespace
}  // namespace formats
