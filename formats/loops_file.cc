// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_file.h"
#include "formats/artefacts.h"

namespace formats {
namespace {

constexpr auto kSearchRow = [](auto& row, auto& id, auto& candidates_searched) { row(id, candidates_searched); };
constexpr auto kLoopRow = [](auto& row, auto& id, auto& loop) {
  row(id, loop.constraint, loop.score, loop.accepted, loop.reason);
};

}  // namespace

void WriteLoops(const std::filesystem::path& file, const survey::Loops& loops, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kLoops, provenance);
  WriteOneRow(writer, "search", loops.candidates_searched, kSearchRow);
  WriteRows(writer, "loops", loops.loops, kLoopRow);
  writer.Commit();
}

survey::Loops ReadLoops(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kLoops);
  survey::Loops loops;
  loops.candidates_searched = ReadOneRow<int>(reader, "search", kSearchRow);
  loops.loops = ReadRows<survey::Loop>(reader, "loops", kLoopRow);
  return loops;
}

}  // namespace formats
