// SPDX-License-Identifier: Apache-2.0
//
// A checksum of a GeoTIFF's content, in its metadata: neither GDAL nor libtiff notices damaged cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

class GDALDataset;

namespace formats {

// CRC-32 over size (two int32), geotransform (six doubles), the text items of `data` that Plumbline writes, each with
// an end of line, and the cells as stored, band after band, row by row from the north; numbers little-endian.
class RasterDigest {
 public:
  // Size, geotransform and items of a data set that is described.
  explicit RasterDigest(GDALDataset* data);
  // The rows of a band (counted from 1) come in their order; those of other bands may come between them.
  void AddRows(int band, std::span<const std::byte> cells);

  void Store(GDALDataset* data) const;
  // DataError when the data set states another digest or none.
  void Verify(GDALDataset* data, const std::filesystem::path& file) const;

 private:
  struct Sum {
    std::uint32_t crc32 = 0;
    std::uint64_t num_bytes = 0;
  };

  void AddToDescription(std::span<const std::byte> bytes);
  std::string Hex() const;

  std::uint32_t description_ = 0;
  std::vector<Sum> bands_;
};

}  // namespace formats
