// SPDX-License-Identifier: Apache-2.0
#include "formats/raster_digest.h"

#include <gdal_priv.h>

#include <array>
#include <cstdio>

#include "formats/digest.h"
#include "formats/errors.h"

namespace formats {
namespace {

constexpr const char* kDigestItem = "PLUMBLINE_CRC32";

}  // namespace

RasterDigest::RasterDigest(GDALDataset* data) : bands_(static_cast<std::size_t>(data->GetRasterCount())) {
  const std::array<std::int32_t, 2> size = {data->GetRasterXSize(), data->GetRasterYSize()};
  std::array<double, 6> transform{};
  data->GetGeoTransform(transform.data());
  for (double& value : transform) value += 0.0;  // no negative zeros
  AddToDescription(std::as_bytes(std::span(size)));
  AddToDescription(std::as_bytes(std::span(transform)));
  for (const char* item : {"PLUMBLINE_CONTENT", "PLUMBLINE_TIED", "PLUMBLINE_CRS", "PLUMBLINE_PROVENANCE"}) {
    const char* text = data->GetMetadataItem(item);
    AddToDescription(std::as_bytes(std::span<const char>(std::string(text == nullptr ? "" : text) + "\n")));
  }
}

void RasterDigest::AddToDescription(std::span<const std::byte> bytes) { description_ = Crc32(bytes, description_); }

void RasterDigest::AddRows(int band, std::span<const std::byte> cells) {
  Sum& sum = bands_[static_cast<std::size_t>(band) - 1];
  sum.crc32 = Crc32(cells, sum.crc32);
  sum.num_bytes += cells.size();
}

std::string RasterDigest::Hex() const {
  std::uint32_t crc32 = description_;
  for (const Sum& band : bands_) crc32 = CombinedCrc32(crc32, band.crc32, band.num_bytes);
  char text[16];
  std::snprintf(text, sizeof text, "%08x", crc32);
  return text;
}

void RasterDigest::Store(GDALDataset* data) const { data->SetMetadataItem(kDigestItem, Hex().c_str()); }

void RasterDigest::Verify(GDALDataset* data, const std::filesystem::path& file) const {
  const char* stored = data->GetMetadataItem(kDigestItem);
  if (stored == nullptr) throw DataError(file.string() + ": has no checksum (" + kDigestItem + ")");
  if (Hex() != stored)
    throw DataError(file.string() + ": damaged: its cells or its description do not agree with its checksum");
}

}  // namespace formats
