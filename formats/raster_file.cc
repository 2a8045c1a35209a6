// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_file.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/raster_crs.h"
#include "formats/raster_description.h"
#include "formats/raster_digest.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::SiteRaster;

constexpr const char* kLogOdds = "occupancy log-odds";
constexpr int kStripRows = 256;  // one row of tiles

// What a band behind the first one holds, by its description.
struct SideBand {
  const char* name;
  const char* unit;
  std::vector<float> SiteRaster::*cells;
};
constexpr std::array kSideBands = {SideBand{kSigmaName, "m", &SiteRaster::sigma_m},
                                   SideBand{kDrawnByName, "", &SiteRaster::drawn_by}};

// Null for a band that is not known.
std::vector<float>* LayerOf(SiteRaster* raster, GDALRasterBand* band) {
  if (band->GetBand() == 1) return &raster->log_odds;
  for (const SideBand& side : kSideBands) {
    if (band->GetDescription() == std::string_view(side.name)) return &(raster->*side.cells);
  }
  return nullptr;
}

bool HasBand(GDALDataset* data, const char* name) {
  for (int band = 2; band <= data->GetRasterCount(); ++band) {
    if (data->GetRasterBand(band)->GetDescription() == std::string_view(name)) return true;
  }
  return false;
}

// Rows from the north.
void AddRows(const std::vector<float>& cells, int width, RasterDigest* digest) {
  const auto row_size = static_cast<std::size_t>(width);
  for (std::size_t row = cells.size() / row_size; row-- > 0;)
    digest->AddRow(std::as_bytes(std::span(cells).subspan(row * row_size, row_size)));
}

// Writes rows from the north (file order) out of rows from the south.
template <typename T>
CPLErr WriteFlipped(GDALRasterBand* band, const std::vector<T>& cells, int width, int height, GDALDataType type) {
  CPLErr status = CE_None;
  for (int row = 0; row < height && status == CE_None; ++row) {
    const T* begin = cells.data() + static_cast<std::size_t>(height - 1 - row) * static_cast<std::size_t>(width);
    status = band->RasterIO(GF_Write, 0, row, width, 1, const_cast<T*>(begin), width, 1, type, 0, 0, nullptr);
  }
  return status;
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
  std::vector<float> cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = 0; row < height; ++row) {
    float* begin = cells.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    const int file_row = band->GetYSize() - 1 - first - row;
    if (band->RasterIO(GF_Read, 0, file_row, width, 1, begin, width, 1, GDT_Float32, 0, 0, nullptr) != CE_None) break;
  }
  return cells;
}

// The rows of `raster` out of the file's array, which begins at `file_min_row`.
void ReadCells(GDALDataset* data, std::int64_t file_min_row, SiteRaster* raster) {
  const int first = static_cast<int>(raster->min_row - file_min_row);
  for (int band = 1; band <= data->GetRasterCount(); ++band)
    *LayerOf(raster, data->GetRasterBand(band)) = ReadBand(data->GetRasterBand(band), first, raster->height);
}

GDALDatasetUniquePtr OpenLogOdds(const fs::path& file, const GdalSession& session) {
  const char* const drivers[] = {"GTiff", nullptr};
  GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  SiteRaster known;
  bool all_known = true;
  for (int band = 1; band <= data->GetRasterCount(); ++band)
    all_known = all_known && LayerOf(&known, data->GetRasterBand(band)) != nullptr;
  if (!all_known || data->GetRasterBand(1)->GetRasterDataType() != GDT_Float32 ||
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
      AddRows(ReadBand(data->GetRasterBand(band), first, end - first), data->GetRasterXSize(), &digest);
      session.ThrowIfFailed(file, "cannot be read to its end");
    }
  }
  digest.Verify(data, file);
}

}  // namespace

void WriteRaster(const fs::path& file, const SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance) {
  RequireCells(file, raster);
  AtomicFile output(file);
  const GdalSession session;
  std::vector<SideBand> sides;
  for (const SideBand& side : kSideBands) {
    if (!(raster.*side.cells).empty()) sides.push_back(side);
  }
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", "256");
  options.SetNameValue("BLOCKYSIZE", "256");
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("PREDICTOR", "3");
  options.SetNameValue("INTERLEAVE", "BAND");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      output.temporary().c_str(), raster.width, raster.height, static_cast<int>(sides.size()) + 1, GDT_Float32,
      options.List()));
  if (!data) session.Throw(file, "could not be written");
  Describe(data.get(), raster, label, provenance, kLogOdds);
  data->GetRasterBand(1)->SetNoDataValue(survey::kUnknownLogOdds);
  RasterDigest digest(data.get());
  AddRows(raster.log_odds, raster.width, &digest);
  for (const SideBand& side : sides) AddRows(raster.*side.cells, raster.width, &digest);
  digest.Store(data.get());
  for (std::size_t i = 0; i < sides.size(); ++i)
    DescribeBand(data->GetRasterBand(static_cast<int>(i) + 2), sides[i].name, sides[i].unit);
  WriteFlipped(data->GetRasterBand(1), raster.log_odds, raster.width, raster.height, GDT_Float32);
  for (std::size_t i = 0; i < sides.size(); ++i)
    WriteFlipped(data->GetRasterBand(static_cast<int>(i) + 2), raster.*sides[i].cells, raster.width, raster.height,
                 GDT_Float32);
  data.reset();
  session.ThrowIfFailed(file, "could not be written (disk full?)");
  output.Commit();
}

SiteRaster ReadRaster(const fs::path& file, RasterLabel* label) {
  const GdalSession session;
  const GDALDatasetUniquePtr data = OpenLogOdds(file, session);
  SiteRaster raster;
  ReadGeoreference(file, data.get(), &raster);
  VerifyCells(file, data.get(), session);
  ReadCells(data.get(), raster.min_row, &raster);
  session.ThrowIfFailed(file, "cannot be read to its end");
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
