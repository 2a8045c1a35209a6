// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_file.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/map_codes.h"
#include "formats/raster_crs.h"
#include "formats/raster_description.h"
#include "formats/raster_digest.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::SiteRaster;

constexpr const char* kLogOdds = "occupancy log-odds";
constexpr int kStripRows = 256;  // one row of tiles

// Null for a band that is not known: it is not read.
std::vector<float>* LayerOf(SiteRaster* raster, GDALRasterBand* band) {
  if (band->GetBand() == 1) return &raster->log_odds;
  return band->GetDescription() == std::string_view(kSigmaName) ? &raster->sigma_m : nullptr;
}

bool HasBand(GDALDataset* data, const char* name) {
  for (int band = 2; band <= data->GetRasterCount(); ++band) {
    if (data->GetRasterBand(band)->GetDescription() == std::string_view(name)) return true;
  }
  return false;
}

// `cells` come row by row from the south.
void AddToDigest(int band, const std::vector<float>& cells, int width, RasterDigest* digest) {
  const auto row_size = static_cast<std::size_t>(width);
  for (std::size_t row = cells.size() / row_size; row-- > 0;)
    digest->AddRows(band, std::as_bytes(std::span(cells).subspan(row * row_size, row_size)));
}

std::string MetadataOf(GDALDataset* data, const char* item) {
  const char* value = data->GetMetadataItem(item);
  return value == nullptr ? "" : value;
}

void ReadGeoreference(const fs::path& file, GDALDataset* data, SiteRaster* raster) {
  std::array<double, 6> transform{};
  if (data->GetGeoTransform(transform.data()) != CE_None) throw DataError(file.string() + ": has no georeference");
  raster->cell_size_m = transform[1];
  if (!(transform[1] > 0) || transform[5] != -transform[1] || transform[2] != 0 || transform[4] != 0)
    throw DataError(file.string() + ": is not a north-up raster of square cells");
  const double column = transform[0] / raster->cell_size_m;
  const double row = transform[3] / raster->cell_size_m;
  if (std::abs(column - std::round(column)) > 1e-4 || std::abs(row - std::round(row)) > 1e-4)
    throw DataError(file.string() + ": its origin is not a multiple of the cell size");
  raster->width = data->GetRasterXSize();
  raster->height = data->GetRasterYSize();
  raster->min_column = std::llround(column);
  raster->min_row = std::llround(row) - raster->height;
}

// Rows [first, first + height) of a band, counted from the south.
std::vector<float> ReadBand(GDALRasterBand* band, int first, int height) {
  const int width = band->GetXSize();
  const std::size_t before_last_row = static_cast<std::size_t>(width) * static_cast<std::size_t>(height - 1);
  std::vector<float> cells(before_last_row + static_cast<std::size_t>(width));
  // The file's first row is the last one of the array.
  const auto row_bytes = static_cast<GSpacing>(sizeof(float)) * width;
  if (band->RasterIO(GF_Read, 0, band->GetYSize() - first - height, width, height, cells.data() + before_last_row,
                     width, height, GDT_Float32, sizeof(float), -row_bytes, nullptr) != CE_None)
    cells.clear();
  return cells;
}

// The rows of `raster` out of the file's array, which begins at `file_min_row`. `use` sees the cells of each band.
void ReadCells(GDALDataset* data, std::int64_t file_min_row, SiteRaster* raster,
               const std::function<void(int band, const std::vector<float>&)>& use = {}) {
  const int first = static_cast<int>(raster->min_row - file_min_row);
  for (int band = 1; band <= data->GetRasterCount(); ++band) {
    std::vector<float> cells = ReadBand(data->GetRasterBand(band), first, raster->height);
    if (use) use(band, cells);
    if (std::vector<float>* layer = LayerOf(raster, data->GetRasterBand(band))) *layer = std::move(cells);
  }
}

GDALDatasetUniquePtr OpenLogOdds(const fs::path& file, const GdalSession& session) {
  const char* const drivers[] = {"GTiff", nullptr};
  GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  if (data->GetRasterCount() == 0 || data->GetRasterBand(1)->GetRasterDataType() != GDT_Float32 ||
      MetadataOf(data.get(), kContentItem) != kLogOdds)
    throw DataError(file.string() + ": is not an occupancy raster of Plumbline (a band of log-odds, metadata item " +
                    kContentItem + ")");
  return data;
}

RasterLabel LabelOf(const fs::path& file, GDALDataset* data) {
  const std::string tied = MetadataOf(data, kTiedItem);
  if (tied != "yes" && tied != "no")
    throw DataError(file.string() + ": " + kTiedItem + " = \"" + tied + "\": must be yes or no");
  RasterLabel label{.frame = {}, .tied = tied == "yes"};
  label.frame.crs = MetadataOf(data, kCrsItem);
  label.frame.wkt2 = Wkt2OfCrs(label.frame.crs);
  return label;
}

// Band after band, a strip of rows from the north at a time: files of any size are checked whole.
void VerifyCells(const fs::path& file, GDALDataset* data, const GdalSession& session) {
  RasterDigest digest(data);
  for (int band = 1; band <= data->GetRasterCount(); ++band) {
    for (int end = data->GetRasterYSize(); end > 0; end -= kStripRows) {
      const int first = std::max(0, end - kStripRows);
      AddToDigest(band, ReadBand(data->GetRasterBand(band), first, end - first), data->GetRasterXSize(), &digest);
      session.ThrowIfFailed(file, "cannot be read to its end");
    }
  }
  digest.Verify(data, file);
}

GDALDatasetUniquePtr CreateLogOdds(const fs::path& file, const survey::RasterStrips& strips) {
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", "256");
  options.SetNameValue("BLOCKYSIZE", std::to_string(kStripRows).c_str());
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("ZLEVEL", "1");
  options.SetNameValue("SPARSE_OK", "TRUE");  // tiles where nothing was observed take no room
  options.SetNameValue("INTERLEAVE", "BAND");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  return GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file.c_str(), strips.frame.width, strips.frame.height, strips.has_sigma ? 2 : 1, GDT_Float32, options.List()));
}

// The layers of the bands, in their order.
std::vector<Layer> LayersOf(const survey::RasterStrips& strips) {
  if (strips.has_sigma) return {&SiteRaster::log_odds, &SiteRaster::sigma_m};
  return {&SiteRaster::log_odds};
}

// Calls use(band, first row, cells) for one row of tiles after the other; rows from the north, as in the file.
void ForEachTileRow(const survey::RasterStrips& strips, const std::function<void(int, int, std::vector<float>&)>& use) {
  const SiteRaster& frame = strips.frame;
  const std::vector<Layer> layers = LayersOf(strips);
  std::vector<float> cells;
  for (int first = 0; first < frame.height; first += kStripRows) {
    const int height = std::min(kStripRows, frame.height - first);
    const SiteRaster rows = strips.read(frame.min_row + frame.height - first - height, height);
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const std::vector<float>& layer = rows.*layers[i];
      cells.clear();
      for (auto end = layer.end(); end != layer.begin(); end -= frame.width)
        cells.insert(cells.end(), end - frame.width, end);
      use(static_cast<int>(i) + 1, first, cells);
    }
  }
}

}  // namespace

void WriteRaster(const fs::path& file, const survey::RasterStrips& strips, const RasterLabel& label,
                 const Provenance& provenance) {
  RequireCells(file, strips.frame);
  AtomicFile output(file);
  const GdalSession session;
  GDALDatasetUniquePtr data = CreateLogOdds(output.temporary(), strips);
  if (!data) session.Throw(file, "could not be written");
  Describe(data.get(), strips.frame, label, provenance, kLogOdds);
  data->GetRasterBand(1)->SetNoDataValue(survey::kUnknownLogOdds);
  if (strips.has_sigma) DescribeBand(data->GetRasterBand(2), kSigmaName, "m");
  // The checksum comes first: a file that is cut off keeps its description, and shows that it is broken.
  RasterDigest digest(data.get());
  ForEachTileRow(strips, [&](int band, int, const std::vector<float>& cells) {
    digest.AddRows(band, std::as_bytes(std::span(cells)));
  });
  digest.Store(data.get());
  // Each row of tiles at once, so that the place of a tile in the file does not depend on GDAL's memory.
  ForEachTileRow(strips, [&](int number, int first_row, std::vector<float>& cells) {
    const int width = strips.frame.width;
    const int height = static_cast<int>(cells.size()) / width;
    GDALRasterBand* band = data->GetRasterBand(number);
    if (band->RasterIO(GF_Write, 0, first_row, width, height, cells.data(), width, height, GDT_Float32, 0, 0,
                       nullptr) == CE_None)
      band->FlushCache(false);
  });
  data.reset();
  session.ThrowIfFailed(file, "could not be written (disk full?)");
  output.Commit();
}

void WriteRaster(const fs::path& file, const SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance) {
  WriteRaster(file, survey::StripsOf(raster), label, provenance);
}

SiteRaster ReadRaster(const fs::path& file, RasterLabel* label) {
  const GdalSession session;
  const GDALDatasetUniquePtr data = OpenLogOdds(file, session);
  SiteRaster raster;
  ReadGeoreference(file, data.get(), &raster);
  RasterDigest digest(data.get());
  ReadCells(data.get(), raster.min_row, &raster,
            [&](int band, const std::vector<float>& cells) { AddToDigest(band, cells, raster.width, &digest); });
  session.ThrowIfFailed(file, "cannot be read to its end");
  digest.Verify(data.get(), file);
  const RasterLabel own = LabelOf(file, data.get());
  if (label != nullptr) *label = own;
  return raster;
}

SiteRaster ReadRasterFrame(const fs::path& file, RasterLabel* label) {
  const GdalSession session;
  const char* const drivers[] = {"GTiff", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  SiteRaster frame;
  ReadGeoreference(file, data.get(), &frame);
  *label = LabelOf(file, data.get());
  return frame;
}

survey::RasterStrips OpenRaster(const fs::path& file, RasterLabel* label) {
  survey::RasterStrips strips;
  {
    const GdalSession session;
    const GDALDatasetUniquePtr data = OpenLogOdds(file, session);
    ReadGeoreference(file, data.get(), &strips.frame);
    VerifyCells(file, data.get(), session);
    strips.has_sigma = HasBand(data.get(), kSigmaName);
    *label = LabelOf(file, data.get());
  }
  // Opened anew for each strip: a site may have more blocks than a process may have open files.
  strips.read = [file, frame = strips.frame](std::int64_t min_row, int height) {
    const GdalSession session;
    const GDALDatasetUniquePtr data = OpenLogOdds(file, session);
    SiteRaster rows = survey::RowsOf(frame, min_row, height);
    ReadCells(data.get(), frame.min_row, &rows);
    session.ThrowIfFailed(file, "cannot be read to its end");
    return rows;
  };
  return strips;
}

}  // namespace formats
