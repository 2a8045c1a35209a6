// SPDX-License-Identifier: Apache-2.0
#include <gdal_priv.h>

#include <nlohmann/json.hpp>

#include "formats/errors.h"
#include "formats/gdal_session.h"
#include "formats/json_text.h"
#include "formats/provenance.h"

namespace formats {

std::optional<Provenance> ProvenanceOfGeoTiff(const std::filesystem::path& file) {
  const GdalSession session;
  const char* const drivers[] = {"GTiff", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  if (!data) session.Throw(file, "cannot be read as GeoTIFF");
  const char* text = data->GetMetadataItem("PLUMBLINE_PROVENANCE");
  if (text == nullptr) return std::nullopt;
  const nlohmann::json json = JsonOrDiscarded(text);
  if (json.is_discarded()) throw DataError(file.string() + ": damaged: the provenance is not JSON");
  return ProvenanceFromJson(json);
}

}  // namespace formats
