// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pipeline {

// The candidate with the fewest single-letter changes from `word`; empty when none is close (more than half of its
// letters differ).
std::string Nearest(const std::string& word, const std::vector<std::string>& candidates);

// "a, b, c"
std::string Joined(const std::vector<std::string>& words);

// "; did you mean NEAREST?" or, when nothing is near, "; known: a, b, c".
std::string Suggestion(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace pipeline
