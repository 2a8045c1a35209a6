// SPDX-License-Identifier: Apache-2.0
//
// Where an artefact comes from. Stored inside every artefact together with the records of all its ancestors, so that
// one file tells the whole chain back to the raw logs. Holds no date, host, user, absolute path or thread count: equal
// inputs give equal bytes.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace formats {

// As much of a record's id or a digest as people compare.
inline std::string ShortId(const std::string& id) { return id.substr(0, 16); }

// One input of a stage. `role` is the stage's word for it ("session", "control", "raw log field.log").
struct ProvenanceInput {
  std::string role;
  std::string sha256;  // of the file's bytes, or of the text without comments where `comments_ignored`
  bool comments_ignored = false;
  std::string record_id;  // id of the input's own record; empty for files that people or instruments made

  bool operator==(const ProvenanceInput&) const = default;
};

// One run of one stage. id = SHA-256 of the record's canonical JSON without the id.
struct ProvenanceRecord {
  std::string stage;
  std::string version;
  std::map<std::string, std::string> options;  // effective values of the options that shape the output
  std::vector<ProvenanceInput> inputs;         // in order of role

  std::string Id() const;
};

// The artefact's own record first, then its ancestors ordered by id.
struct Provenance {
  std::vector<ProvenanceRecord> records;

  const ProvenanceRecord& Own() const { return records.front(); }
};

// The same run with some of its inputs, for an artefact that shows no more of the others than what `inputs` tell: its
// own record and the records that these descend from.
Provenance WithInputs(const Provenance& whole, std::vector<ProvenanceInput> inputs);

nlohmann::json ToJson(const Provenance& provenance);
std::string JsonTextOf(const Provenance& provenance);       // in one line
Provenance ProvenanceFromJson(const nlohmann::json& json);  // DataError when malformed

// What a file is by its first bytes. DataError when it cannot be read.
enum class FileKind { kSqlite, kGeoTiff, kJson, kOther };
FileKind KindOfFile(const std::filesystem::path& file);

// GeoTIFF needs GDAL, whose libraries take longer to load than many a stage runs. So only programs that use GDAL
// (GdalSession) read it; in all others a GeoTIFF is a DataError.
using GeoTiffProvenanceReader = std::optional<Provenance> (*)(const std::filesystem::path&);
void SetGeoTiffProvenanceReader(GeoTiffProvenanceReader reader);
std::optional<Provenance> ProvenanceOfGeoTiff(const std::filesystem::path& file);

// As ReadProvenance; none for whole TIFF and JSON files without provenance, which are not Plumbline's.
std::optional<Provenance> FindProvenance(const std::filesystem::path& file);

// The provenance stored in an artefact of any kind (SQLite, GeoTIFF, JSON). DataError names the file when it has none.
Provenance ReadProvenance(const std::filesystem::path& file);

}  // namespace formats
