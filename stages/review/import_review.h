// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace review {

// Takes over what a page without a server has saved: {"format": "plumbline-review", "format_version": 1,
// "answers": [{"block", "seen", "answer"}], "operations": [...]}. Nothing is lost: an answer where somebody else has
// answered since is refused and named, before anything is written. Returns a sentence on what was done.
std::string ImportReview(const std::filesystem::path& site, const std::filesystem::path& file);

}  // namespace review
