// SPDX-License-Identifier: Apache-2.0
//
// Which names a site may contain. GNU make separates words by blanks and gives other characters a meaning, so names are
// kept plain, and a block must not be called like something that can be a target.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pipeline {

// UsageError names the rule that the name breaks.
void CheckBlockName(const std::string& name, const std::vector<std::string>& stages);

// Letters (any beyond ASCII too), digits and _ . - + , @: what a file supplied by people may be called.
bool IsPlainName(const std::string& name);

// Names of the folders in blocks/, sorted.
std::vector<std::string> BlocksOf(const std::filesystem::path& site);

// Relative paths of all files that people supply: everything below control/, blocks/, edits/ and delivered/ but hidden
// files; sorted. DataError names a file whose name make cannot handle and a link that leads nowhere.
std::vector<std::filesystem::path> SuppliedFiles(const std::filesystem::path& site);

}  // namespace pipeline
