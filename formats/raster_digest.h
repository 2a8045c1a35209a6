// SPDX-License-Identifier: Apache-2.0
//
// A checksum of a GeoTIFF's content, in its metadata: neither GDAL nor libtiff notices damaged cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

class GDALDataset;

namespace formats {

// CRC-32 over size (two int32), geotransform (six doubles), the text items of `data` that Plumbline writes, each with
// an end of line, and the cells as stored, row by row from the north; numbers little-endian.
class RasterDigest {
 public:
  // Size, geotransform and items of a data set that is described.
  explicit RasterDigest(GDALDataset* data);
  void AddRow(std::span<const std::byte> cells) { Add(cells); }

  void Store(GDALDataset* data) const;
  // DataError when the data set states another digest or none.
  void Verify(GDALDataset* data, const std::filesystem::path& file) const;

 private:
  void Add(std::span<const std::byte> bytes);
  std::string Hex() const;

  std::uint32_t crc32_ = 0;
};

}  // namespace formats
