// SPDX-License-Identifier: Apache-2.0
#include "formats/map_tiles.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "formats/errors.h"
#include "formats/raster_file.h"
#include "tests/support/scratch_folder.h"

namespace {

using formats::MapTiles;

// 600 x 500 cells: free, a wall of one cell on the diagonal, unknown in the south-west corner.
survey::SiteRaster Map() {
  survey::SiteRaster raster{.cell_size_m = 0.05, .min_column = 2000, .min_row = 4000, .width = 600, .height = 500};
  raster.log_odds.assign(600U * 500U, -3.0F);
  for (int i = 0; i < 500; ++i) raster.At(i, i) = 3.0F;
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) raster.At(column, row) = survey::kUnknownLogOdds;
  }
  raster.sigma_m.assign(raster.log_odds.size(), 0.01F);
  return raster;
}

formats::Provenance Nothing() { return {.records = {{.stage = "test", .version = "1", .options = {}, .inputs = {}}}}; }

// Grey and opacity of one pixel of a PNG.
std::pair<int, int> Pixel(const std::string& png, int column, int row) {
  GDALAllRegister();
  std::string bytes = png;
  VSIFCloseL(VSIFileFromMemBuffer("/vsimem/tile.png", reinterpret_cast<GByte*>(bytes.data()), bytes.size(), FALSE));
  const GDALDatasetUniquePtr data(GDALDataset::Open("/vsimem/tile.png"));
  GByte values[2] = {0, 0};
  const int bands[2] = {1, 4};
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(data->GetRasterBand(bands[i])->RasterIO(GF_Read, column, row, 1, 1, &values[i], 1, 1, GDT_Byte, 0, 0),
              CE_None);
  return {values[0], values[1]};
}

class MapTilesTest : public testing::Test {
 protected:
  MapTilesTest() {
    formats::WriteRaster(scratch_ / "grid.tif", Map(), {}, Nothing());
    formats::WriteCogMap(scratch_ / "site.tif", Map(), {}, Nothing());
  }
  test_support::ScratchFolder scratch_;
};

TEST_F(MapTilesTest, FrameAndPixels) {
  MapTiles tiles(scratch_ / "grid.tif", MapTiles::Picture::kOccupancy);
  EXPECT_EQ(tiles.frame().north_west, Eigen::Vector2d(100.0, 225.0));
  EXPECT_EQ(tiles.frame().num_levels, 3);
  // Row 0 of a tile is the northernmost: cell (499, 499) lies in the second column of tiles, top row.
  EXPECT_EQ(Pixel(tiles.Tile(0, 1, 0), 499 - 256, 0), std::make_pair(0, 255));
  EXPECT_EQ(Pixel(tiles.Tile(0, 1, 0), 498 - 256, 0), std::make_pair(255, 255));
  EXPECT_EQ(Pixel(tiles.Tile(0, 0, 1), 10, 490 - 256).second, 0);
  // A wall of one cell is still there in the coarsest level, four cells to a pixel.
  EXPECT_EQ(Pixel(tiles.Tile(2, 0, 0), 499 / 4, 0), std::make_pair(0, 255));
}

TEST_F(MapTilesTest, OverviewsOfTheFileAreTheLevelsMadeHere) {
  for (const auto picture : {MapTiles::Picture::kOccupancy, MapTiles::Picture::kUncertainty}) {
    MapTiles made(scratch_ / "grid.tif", picture);
    MapTiles on_disk(scratch_ / "site.tif", picture);
    for (int level = 0; level < 3; ++level) {
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 2; ++row) EXPECT_EQ(made.Tile(level, column, row), on_disk.Tile(level, column, row));
      }
    }
  }
}

TEST_F(MapTilesTest, NothingBeyondTheMap) {
  MapTiles tiles(scratch_ / "site.tif", MapTiles::Picture::kOccupancy);
  EXPECT_NE(tiles.Tile(0, 2, 1), "");
  EXPECT_EQ(tiles.Tile(0, 3, 0), "");
  EXPECT_EQ(tiles.Tile(0, 0, 2), "");
  EXPECT_EQ(tiles.Tile(3, 0, 0), "");
  EXPECT_EQ(tiles.Tile(-1, 0, 0), "");
  EXPECT_TRUE(formats::HasUncertainty(scratch_ / "site.tif"));
  EXPECT_THROW(MapTiles(scratch_ / "none.tif", MapTiles::Picture::kOccupancy), formats::DataError);
}

}  // namespace
