// SPDX-License-Identifier: Apache-2.0
//
// The schemas of the SQLite artefacts, word for word as they stand in the files (`sqlite3 FILE .schema` shows them with
// their units). README.md explains them. A change of a schema raises the format's version.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace formats {

enum class ArtefactKind {
  kSession = 1,
  kTrack = 2,
  kLoops = 3,
  kControl = 4,
  kSolution = 5,
  kFeatures = 6,
  kGraph = 7
};

struct ArtefactFormat {
  ArtefactKind kind;
  int version;            // 1..99
  std::string_view name;  // as in messages: "session"
  std::string_view schema;

  // The file's user_version: kind and version in one, so that a file tells what it is.
  int UserVersion() const { return 100 * static_cast<int>(kind) + version; }
};

inline constexpr int kApplicationId = 0x504c4d42;  // "PLMB"

std::span<const ArtefactFormat> AllFormats();
const ArtefactFormat& FormatOf(ArtefactKind kind);
std::optional<ArtefactKind> KindOfUserVersion(int user_version);

// In every artefact beside its own tables.
extern const std::string_view kCommonSchema;

}  // namespace formats
