// SPDX-License-Identifier: Apache-2.0
//
// How a person's edits come into the ledger of a site: tied to the maps on which they were drawn, then appended. All
// tools of people (command line, review page, QGIS) go this way.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/edit_ledger.h"
#include "formats/raster_file.h"
#include "pipeline/stage.h"
#include "survey/edits/anchoring.h"
#include "survey/edits/site_edits.h"

namespace pipeline {

std::filesystem::path LedgerFile(const std::filesystem::path& site);

// By block, the record of the solution that its map in work/ was drawn from: the basis of an edit that is drawn now.
using Basis = std::map<std::string, std::string>;
Basis BasisOf(const std::filesystem::path& site);

// The scans of a solution.sqlite.
survey::BlockPoses ReadBlockPoses(const std::filesystem::path& solution);

// The coordinate system of the site's tied maps; empty without one.
formats::RasterLabel LabelOfSite(const std::filesystem::path& site);

// edits.json of several blocks.
std::vector<survey::BlockEdits> ReadBlockEdits(const std::vector<NamedFile>& files);

// The edits that hold, in order of their uids, where the current maps put them.
std::vector<survey::MapEdit> PlacedEdits(const std::filesystem::path& site);

// The edits of the ledger that were taken back, likewise, where the solutions of the blocks put them.
std::vector<survey::SiteEdit> RetiredEdits(const std::filesystem::path& ledger,
                                           const std::vector<NamedFile>& solutions);

// Ties additions and modifications to the current maps (anchors, beams of masks, more vertices on long lines) and
// appends all lines; see formats::AppendToLedger for what it fills in, what it returns and what it refuses. DataError
// also for an edit that no map can show (none of their cells in it, or a vertex far off), an arrow or a mask where no
// scan saw anything, one drawn before there is a map, and one whose basis is given and is no longer the maps' own: it
// was drawn on something that has changed since. Only the maps that an edit meets are read.
std::optional<std::string> RecordEdits(const std::filesystem::path& site, std::vector<formats::LedgerLine> lines,
                                       const std::optional<std::string>& expected_head = std::nullopt);

}  // namespace pipeline
