// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_formats.h"

#include <array>
#include <stdexcept>

#include "formats/local_schemas.h"
#include "formats/site_schemas.h"

namespace formats {
namespace {

constexpr std::array kFormats = {
    ArtefactFormat{ArtefactKind::kSession, 1, "session", kSessionSchema},
    ArtefactFormat{ArtefactKind::kTrack, 3, "track", kTrackSchema},
    ArtefactFormat{ArtefactKind::kLoops, 1, "loops", kLoopsSchema},
    ArtefactFormat{ArtefactKind::kControl, 2, "control", kControlSchema},
    ArtefactFormat{ArtefactKind::kSolution, 3, "solution", kSolutionSchema},
    ArtefactFormat{ArtefactKind::kFeatures, 2, "features", kFeaturesSchema},
    ArtefactFormat{ArtefactKind::kGraph, 2, "graph", kGraphSchema},
};

}  // namespace

const std::string_view kCommonSchema = R"(
CREATE TABLE provenance (
  position INTEGER PRIMARY KEY CHECK (position >= 0),  -- 0: this file; then its ancestors in order of id
  id TEXT NOT NULL UNIQUE,  -- SHA-256 of record
  stage TEXT NOT NULL,
  record TEXT NOT NULL      -- canonical JSON
) STRICT;
CREATE TABLE end_marker (
  name TEXT PRIMARY KEY,    -- of a table
  num_rows INTEGER NOT NULL,
  crc32 INTEGER NOT NULL    -- of its values in order
) STRICT;
)";

std::span<const ArtefactFormat> AllFormats() { return kFormats; }

const ArtefactFormat& FormatOf(ArtefactKind kind) {
  for (const ArtefactFormat& format : kFormats) {
    if (format.kind == kind) return format;
  }
  throw std::logic_error("artefact kind without a format");
}

std::optional<ArtefactKind> KindOfUserVersion(int user_version) {
  for (const ArtefactFormat& format : kFormats) {
    if (static_cast<int>(format.kind) == user_version / 100) return format.kind;
  }
  return std::nullopt;
}

}  // namespace formats
