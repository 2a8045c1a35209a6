// SPDX-License-Identifier: Apache-2.0
//
// The SQLite artefacts between the stages; schemas and invariants in README.md. Writers are atomic and
// byte-reproducible. Readers check application id, format version, end marker and CRCs and throw DataError naming the
// file. Where a reader takes a Provenance*, it may be null.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/provenance.h"
#include "survey/control/control_point.h"
#include "survey/features/feature.h"
#include "survey/graph/controlled_graph.h"
#include "survey/graph/solution.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace formats {

void WriteSession(const std::filesystem::path& file, const survey::Session& session, const Provenance& provenance);
// Ranges are read from the file as they are asked for: it must not be changed in place (a new one may take its name).
survey::Session ReadSession(const std::filesystem::path& file);

void WriteTrack(const std::filesystem::path& file, const survey::Track& track,
                const std::vector<survey::ScanStamp>& scan_stamps, const Provenance& provenance);
// `scan_stamps`: gets the stamps stored beside the scans.
survey::Track ReadTrack(const std::filesystem::path& file, std::vector<survey::ScanStamp>* scan_stamps = nullptr);

void WriteLoops(const std::filesystem::path& file, const survey::Loops& loops, const Provenance& provenance);
survey::Loops ReadLoops(const std::filesystem::path& file);

void WriteControl(const std::filesystem::path& file, const survey::ControlNetwork& network,
                  const Provenance& provenance);
survey::ControlNetwork ReadControl(const std::filesystem::path& file);

void WriteSolution(const std::filesystem::path& file, const survey::Solution& solution,
                   const std::vector<survey::ScanStamp>& scan_stamps, const Provenance& provenance);
survey::Solution ReadSolution(const std::filesystem::path& file);

// The observations of a block as its adjustment weighted them.
void WriteGraph(const std::filesystem::path& file, const survey::ControlledGraph& graph, const Provenance& provenance);
survey::ControlledGraph ReadGraph(const std::filesystem::path& file);

// Features sought in a block's map, found or not, in the order of the surveyor's list.
void WriteFeatures(const std::filesystem::path& file, const std::vector<survey::MapFeature>& features,
                   const Provenance& provenance);
std::vector<survey::MapFeature> ReadFeatures(const std::filesystem::path& file);

// Stamps of the scans as stored beside the poses of a track or solution, in their order.
std::vector<survey::ScanStamp> ReadScanStamps(const std::filesystem::path& file);

}  // namespace formats
