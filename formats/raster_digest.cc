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

RasterDigest::RasterDigest(GDALDataset* data) {
  const std::array<std::int32_t, 2> size = {data->GetRasterXSize(), data->GetRasterYSize()};
  std::array<double, 6> transform{};
  data->GetGeoTransform(transform.data());
  for (double& value : transform) value += 0.0;  // no negative zeros
  Add(std::as_bytes(std::span(size)));
  Add(std::as_bytes(std::span(transform)));
  for (const char* item : {"PLUMBLINE_CONTENT", "PLUMBLINE_TIED", "PLUMBLINE_CRS", "PLUMBLINE_PROVENANCE"}) {
    const char* text = data->GetMetadataItem(item);
    Add(std::as_bytes(std::span<const char>(std::string(text == nullptr ? "" : text) + "\n")));
  }
}

void RasterDigest::Add(std::span<const std::byte> bytes) { crc32_ = Crc32(bytes, crc32_); }

std::string RasterDigest::Hex() const {
  char text[16];
  std::snprintf(text, sizeof text, "%08x", crc32_);
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
