// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_file.h"

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/raster_crs.h"
#include "formats/raster_digest.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::SiteRaster;

constexpr const char* kProvenanceItem = "PLUMBLINE_PROVENANCE";
constexpr const char* kTiedItem = "PLUMBLINE_TIED";
constexpr const char* kCrsItem = "PLUMBLINE_CRS";
constexpr const char* kContentItem = "PLUMBLINE_CONTENT";
constexpr const char* kLogOdds = "occupancy log-odds";
constexpr const char* kPercent = "occupancy in percent";
constexpr std::uint8_t kUnknownPercent = 255;
constexpr int kCogTile = 512;
constexpr const char* kSigmaName = "positional uncertainty, 1 sigma in the worst direction";
constexpr double kSigmaStep_m = 0.002;  // of the bytes of site.tif; 254: 0.508 m or more

void RequireCells(const fs::path& file, const SiteRaster& raster) {
  if (raster.width <= 0 || raster.height <= 0) throw DataError(file.string() + ": the raster has no cells");
}

// All rows of the bands in the order of the file: from the north, one band after the other.
void AddCells(const SiteRaster& raster, RasterDigest* digest) {
  for (const std::vector<float>* cells : {&raster.log_odds, &raster.sigma_m}) {
    if (cells->empty()) continue;
    const auto width = static_cast<std::size_t>(raster.width);
    for (auto row = static_cast<std::size_t>(raster.height); row-- > 0;)
      digest->AddRow(std::as_bytes(std::span(*cells).subspan(row * width, width)));
  }
}

void DescribeBand(GDALRasterBand* band, const char* name, const char* unit) {
  band->SetDescription(name);
  band->SetUnitType(unit);
}

// x and y of the outer corner of the upper left cell, as GDAL counts.
std::array<double, 6> GeoTransformOf(const SiteRaster& raster) {
  const double s = raster.cell_size_m;
  return {static_cast<double>(raster.min_column) * s,
          s,
          0.0,
          static_cast<double>(raster.min_row + raster.height) * s,
          0.0,
          -s};
}

void Describe(GDALDataset* data, const SiteRaster& raster, const RasterLabel& label, const Provenance& provenance,
              const char* content) {
  std::array<double, 6> transform = GeoTransformOf(raster);
  data->SetGeoTransform(transform.data());
  OGRSpatialReference crs;
  crs.importFromWkt(Wkt2OfLabel(label).c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  data->SetSpatialRef(&crs);
  data->SetMetadataItem("AREA_OR_POINT", "Area");
  data->SetMetadataItem(kContentItem, content);
  data->SetMetadataItem(kTiedItem, label.tied ? "yes" : "no");
  if (label.tied && !label.frame.crs.empty()) data->SetMetadataItem(kCrsItem, label.frame.crs.c_str());
  data->SetMetadataItem(kProvenanceItem, ToJson(provenance).dump().c_str());
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

std::uint8_t PercentOf(float log_odds) {
  if (std::isnan(log_odds)) return kUnknownPercent;
  return static_cast<std::uint8_t>(std::lround(100.0 * survey::ProbabilityFromLogOdds(log_odds)));
}

std::uint8_t SigmaStepsOf(float sigma_m) {
  if (std::isnan(sigma_m)) return kUnknownPercent;
  return static_cast<std::uint8_t>(std::lround(std::min(254.0, static_cast<double>(sigma_m) / kSigmaStep_m)));
}

struct ByteImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> cells;  // rows from the north
};

template <typename ToByte>
ByteImage ImageOf(const SiteRaster& raster, const std::vector<float>& values, const ToByte& to_byte) {
  ByteImage image{raster.width, raster.height, {}};
  image.cells.reserve(values.size());
  for (int row = raster.height - 1; row >= 0; --row) {
    for (int column = 0; column < raster.width; ++column)
      image.cells.push_back(to_byte(values[raster.Index(column, row)]));
  }
  return image;
}

// Half size; each cell takes the largest value below it: thin walls survive in the overviews, sigmas stay safe.
ByteImage Halved(const ByteImage& fine) {
  ByteImage coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
  coarse.cells.assign(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height),
                      kUnknownPercent);
  for (int row = 0; row < fine.height; ++row) {
    for (int column = 0; column < fine.width; ++column) {
      const std::uint8_t value = fine.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(fine.width) +
                                            static_cast<std::size_t>(column)];
      std::uint8_t& cell = coarse.cells[static_cast<std::size_t>(row / 2) * static_cast<std::size_t>(coarse.width) +
                                        static_cast<std::size_t>(column / 2)];
      if (value != kUnknownPercent && (cell == kUnknownPercent || value > cell)) cell = value;
    }
  }
  return coarse;
}

CPLErr WriteImage(GDALRasterBand* band, ByteImage& image) {
  return band->RasterIO(GF_Write, 0, 0, image.width, image.height, image.cells.data(), image.width, image.height,
                        GDT_Byte, 0, 0, nullptr);
}

// The band and its overviews.
bool FillBand(GDALRasterBand* band, ByteImage image) {
  band->SetNoDataValue(kUnknownPercent);
  if (WriteImage(band, image) != CE_None) return false;
  for (int level = 0; level < band->GetOverviewCount(); ++level) {
    image = Halved(image);
    if (WriteImage(band->GetOverview(level), image) != CE_None) return false;
  }
  return true;
}

// The images, a band each, with their overviews in memory; the COG driver copies both.
GDALDatasetUniquePtr PyramidInMemory(const std::vector<ByteImage>& images) {
  auto* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  const int width = images.front().width;
  const int height = images.front().height;
  const int bands = static_cast<int>(images.size());
  GDALDatasetUniquePtr data(memory->Create("", width, height, bands, GDT_Byte, nullptr));
  if (!data) return data;
  std::vector<int> factors;
  for (int factor = 2; std::max(width, height) / factor * 2 > kCogTile; factor *= 2) factors.push_back(factor);
  if (!factors.empty() && data->BuildOverviews("NEAREST", static_cast<int>(factors.size()), factors.data(), 0, nullptr,
                                               nullptr, nullptr) != CE_None)
    return nullptr;
  for (int band = 1; band <= bands; ++band) {
    if (!FillBand(data->GetRasterBand(band), images[static_cast<std::size_t>(band) - 1])) return nullptr;
  }
  return data;
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

std::vector<float> ReadCells(GDALRasterBand* band, const SiteRaster& raster) {
  const auto width = static_cast<std::size_t>(raster.width);
  const auto height = static_cast<std::size_t>(raster.height);
  std::vector<float> cells(width * height);
  for (std::size_t row = 0; row < height; ++row) {
    float* begin = cells.data() + (height - 1 - row) * width;
    if (band->RasterIO(GF_Read, 0, static_cast<int>(row), raster.width, 1, begin, raster.width, 1, GDT_Float32, 0, 0,
                       nullptr) != CE_None)
      break;
  }
  return cells;
}

}  // namespace

void WriteRaster(const fs::path& file, const SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance) {
  RequireCells(file, raster);
  AtomicFile output(file);
  const GdalSession session;
  const int bands = raster.sigma_m.empty() ? 1 : 2;
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", "256");
  options.SetNameValue("BLOCKYSIZE", "256");
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("PREDICTOR", "3");
  options.SetNameValue("INTERLEAVE", "BAND");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      output.temporary().c_str(), raster.width, raster.height, bands, GDT_Float32, options.List()));
  if (!data) session.Throw(file, "could not be written");
  Describe(data.get(), raster, label, provenance, kLogOdds);
  data->GetRasterBand(1)->SetNoDataValue(survey::kUnknownLogOdds);
  RasterDigest digest(data.get());
  AddCells(raster, &digest);
  digest.Store(data.get());
  if (bands == 2) DescribeBand(data->GetRasterBand(2), kSigmaName, "m");
  WriteFlipped(data->GetRasterBand(1), raster.log_odds, raster.width, raster.height, GDT_Float32);
  if (bands == 2) WriteFlipped(data->GetRasterBand(2), raster.sigma_m, raster.width, raster.height, GDT_Float32);
  data.reset();
  session.ThrowIfFailed(file, "could not be written (disk full?)");
  output.Commit();
}

SiteRaster ReadRaster(const fs::path& file, RasterLabel* label) {
  const GdalSession session;
  const char* const drivers[] = {"GTiff", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  if (data->GetRasterCount() > 2 || data->GetRasterBand(1)->GetRasterDataType() != GDT_Float32 ||
      MetadataOf(data.get(), kContentItem) != kLogOdds)
    throw DataError(file.string() + ": is not an occupancy raster of Plumbline (a band of log-odds, metadata item " +
                    kContentItem + ")");
  SiteRaster raster;
  ReadGeoreference(file, data.get(), &raster);
  raster.log_odds = ReadCells(data->GetRasterBand(1), raster);
  if (data->GetRasterCount() == 2) raster.sigma_m = ReadCells(data->GetRasterBand(2), raster);
  session.ThrowIfFailed(file, "cannot be read to its end");
  RasterDigest digest(data.get());
  AddCells(raster, &digest);
  digest.Verify(data.get(), file);
  const std::string tied = MetadataOf(data.get(), kTiedItem);
  if (tied != "yes" && tied != "no")
    throw DataError(file.string() + ": " + kTiedItem + " = \"" + tied + "\": must be yes or no");
  if (label != nullptr) {
    label->tied = tied == "yes";
    label->frame.crs = MetadataOf(data.get(), kCrsItem);
    label->frame.wkt2 = Wkt2OfCrs(label->frame.crs);
  }
  return raster;
}

void WriteCogMap(const fs::path& file, const SiteRaster& raster, const RasterLabel& label,
                 const Provenance& provenance) {
  RequireCells(file, raster);
  AtomicFile output(file);
  const GdalSession session;
  std::vector<ByteImage> images = {ImageOf(raster, raster.log_odds, PercentOf)};
  if (!raster.sigma_m.empty()) images.push_back(ImageOf(raster, raster.sigma_m, SigmaStepsOf));
  const GDALDatasetUniquePtr memory = PyramidInMemory(images);
  if (!memory) session.Throw(file, "could not be composed in memory");
  Describe(memory.get(), raster, label, provenance, kPercent);
  RasterDigest digest(memory.get());
  for (const ByteImage& image : images) digest.AddRow(std::as_bytes(std::span(image.cells)));
  digest.Store(memory.get());
  DescribeBand(memory->GetRasterBand(1), "occupancy", "percent");
  if (images.size() == 2) {
    DescribeBand(memory->GetRasterBand(2), kSigmaName, "m");
    memory->GetRasterBand(2)->SetScale(kSigmaStep_m);
  }
  CPLStringList options;
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("BLOCKSIZE", std::to_string(kCogTile).c_str());
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  options.SetNameValue("NUM_THREADS", "1");
  GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("COG")->CreateCopy(
      output.temporary().c_str(), memory.get(), TRUE, options.List(), nullptr, nullptr));
  const bool created = data != nullptr;
  data.reset();
  if (!created) session.Throw(file, "could not be written (disk full?)");
  session.ThrowIfFailed(file, "could not be written (disk full?)");
  output.Commit();
}

}  // namespace formats
