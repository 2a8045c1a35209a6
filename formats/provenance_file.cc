// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/artefact_file.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "formats/provenance.h"

namespace formats {
namespace {

using namespace std::string_view_literals;

std::string FirstBytes(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw DataError(file.string() + ": is a folder");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw DataError(file.string() + ": cannot be read");
  std::string bytes(16, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

constinit GeoTiffProvenanceReader geo_tiff_reader = nullptr;

std::optional<Provenance> OfGeoTiff(const std::filesystem::path& file) {
  if (geo_tiff_reader == nullptr) throw DataError(file.string() + ": is a raster; this program reads none");
  return geo_tiff_reader(file);
}

std::optional<Provenance> OfJson(const std::filesystem::path& file) {
  std::string text = ReadWholeFile(file);
  if (file.extension() == ".jsonl") text.resize(text.find('\n') == std::string::npos ? 0 : text.find('\n'));
  const nlohmann::json json = JsonOrDiscarded(text);
  if (json.is_discarded()) throw DataError(file.string() + ": not valid JSON (truncated?)");
  if (!json.contains("provenance")) return std::nullopt;
  return ProvenanceFromJson(json.at("provenance"));
}

}  // namespace

void SetGeoTiffProvenanceReader(GeoTiffProvenanceReader reader) { geo_tiff_reader = reader; }

FileKind KindOfFile(const std::filesystem::path& file) {
  const std::string bytes = FirstBytes(file);
  if (bytes.starts_with("SQLite format 3")) return FileKind::kSqlite;
  const std::string_view magic = std::string_view(bytes).substr(0, 4);
  for (const std::string_view tiff : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv}) {
    if (magic == tiff) return FileKind::kGeoTiff;
  }
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start != std::string::npos && bytes[start] == '{') return FileKind::kJson;
  return FileKind::kOther;
}

std::optional<Provenance> FindProvenance(const std::filesystem::path& file) {
  try {
    switch (KindOfFile(file)) {
      case FileKind::kSqlite:
        return ArtefactReader(file).ReadProvenance();
      case FileKind::kGeoTiff:
        return OfGeoTiff(file);
      case FileKind::kJson:
        return OfJson(file);
      case FileKind::kOther:
        break;
    }
  } catch (const DataError& error) {
    const std::string message = error.what();
    throw DataError(message.starts_with(file.string()) ? message : file.string() + ": " + message);
  }
  throw DataError(file.string() + ": not an artefact (neither SQLite, GeoTIFF nor JSON; truncated?)");
}

Provenance ReadProvenance(const std::filesystem::path& file) {
  std::optional<Provenance> provenance = FindProvenance(file);
  if (!provenance) throw DataError(file.string() + ": has no provenance: not one of Plumbline's artefacts");
  return *std::move(provenance);
}

}  // namespace formats
