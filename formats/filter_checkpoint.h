// SPDX-License-Identifier: Apache-2.0
//
// What the particle filter keeps for its next run: the trajectory tree, from which the maps of all particles can be
// drawn again, with the answers that it was computed with. Not an artefact: nothing reads it but `track`, which comes
// to the same result without it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "survey/particles/trajectory_tree.h"
#include "survey/submaps/answer.h"

namespace formats {

// What an answer makes the filter do, and from which scan on.
struct FilterAnswer {
  survey::ScanId from;
  std::string meaning;

  bool operator==(const FilterAnswer&) const = default;
};

struct FilterCheckpoint {
  std::string key;  // of program, session and options
  std::vector<FilterAnswer> answers;
  survey::TrajectoryTree tree;
};

std::vector<FilterAnswer> AnswersInFilter(const survey::Answers& answers);

// The updates of a checkpoint that hold with other answers: those before the first scan at which the filter does
// something else.
survey::TrajectoryTree UpdatesThatHold(const FilterCheckpoint& checkpoint, const std::vector<FilterAnswer>& answers);

void WriteCheckpoint(const std::filesystem::path& file, const FilterCheckpoint& checkpoint);

// Empty when there is none, or one that is damaged.
std::optional<FilterCheckpoint> ReadCheckpoint(const std::filesystem::path& file);

}  // namespace formats
