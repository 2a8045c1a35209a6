// SPDX-License-Identifier: Apache-2.0
#include "formats/scratch_raster.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <algorithm>
#include <vector>

#include "formats/map_codes.h"

namespace formats {
namespace {

constexpr int kTile = 512;

CPLErr Transfer(GDALRasterBand* band, GDALRWFlag direction, int first_row, int num_rows, std::uint8_t* rows) {
  return band->RasterIO(direction, 0, first_row, band->GetXSize(), num_rows, rows, band->GetXSize(), num_rows, GDT_Byte,
                        0, 0, nullptr);
}

}  // namespace

ScratchRaster::ScratchRaster(const std::filesystem::path& target, const survey::SiteRaster& frame, int num_bands,
                             const GdalSession& session)
    : target_(target), session_(session), file_(target.string() + ".cells.tif") {
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", std::to_string(kTile).c_str());
  options.SetNameValue("BLOCKYSIZE", std::to_string(kTile).c_str());
  options.SetNameValue("INTERLEAVE", "BAND");
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("ZLEVEL", "1");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  data_.reset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file_.temporary().c_str(), frame.width, frame.height, num_bands, GDT_Byte, options.List()));
  Check(data_ != nullptr);
}

void ScratchRaster::Close::operator()(GDALDataset* data) const { GDALClose(data); }

void ScratchRaster::Check(bool good) const {
  if (!good) session_.Throw(target_, "could not be written (disk full?)");
}

void ScratchRaster::Write(int band, int first_row, std::span<std::uint8_t> rows) {
  const int num_rows = static_cast<int>(rows.size()) / data_->GetRasterXSize();
  Check(Transfer(data_->GetRasterBand(band), GF_Write, first_row, num_rows, rows.data()) == CE_None);
}

void ScratchRaster::BuildOverviews(int smallest, std::uint8_t unknown) {
  std::vector<int> factors;
  const int size = std::max(data_->GetRasterXSize(), data_->GetRasterYSize());
  for (int factor = 2; size / factor * 2 > smallest; factor *= 2) factors.push_back(factor);
  if (factors.empty()) return;
  Check(data_->BuildOverviews("NONE", static_cast<int>(factors.size()), factors.data(), 0, nullptr, nullptr, nullptr) ==
        CE_None);
  for (int band = 1; band <= data_->GetRasterCount(); ++band) {
    GDALRasterBand* fine = data_->GetRasterBand(band);
    for (int level = 0; level < static_cast<int>(factors.size()); ++level) {
      GDALRasterBand* coarse = data_->GetRasterBand(band)->GetOverview(level);
      HalveInto(fine, coarse, unknown);
      fine = coarse;
    }
  }
}

void ScratchRaster::HalveInto(GDALRasterBand* fine, GDALRasterBand* coarse, std::uint8_t unknown) {
  const int width = fine->GetXSize();
  for (int first = 0; first < fine->GetYSize(); first += 2 * kTile) {
    const int height = std::min(2 * kTile, fine->GetYSize() - first);
    std::vector<std::uint8_t> rows(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    Check(Transfer(fine, GF_Read, first, height, rows.data()) == CE_None);
    std::vector<std::uint8_t> halved = Halved(rows, width, unknown);
    Check(Transfer(coarse, GF_Write, first / 2, (height + 1) / 2, halved.data()) == CE_None);
  }
}

void ScratchRaster::CopyTo(const char* driver, char** options) {
  AtomicFile output(target_);
  GDALDatasetUniquePtr copy(GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy(
      output.temporary().c_str(), data_.get(), TRUE, options, nullptr, nullptr));
  const bool created = copy != nullptr;
  copy.reset();
  Check(created);
  data_.reset();
  session_.ThrowIfFailed(target_, "could not be written (disk full?)");
  output.Commit();
}

}  // namespace formats
