// SPDX-License-Identifier: Apache-2.0
//
// site.toml and blocks/B/block.toml, split into one configuration slice per stage run. A slice holds only the keys that
// its stage knows, so a changed key re-runs only the stages that know it, and names the stage's build in a comment, so
// that a new program re-runs its stage.
//
// Tables: [site] and [sensors] give their keys to every stage that has an option of that name; a table named after a
// stage gives them to that stage. block.toml may hold [sensors] and tables of the stages that run per block; its values
// replace the site's.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/stage_program.h"

namespace pipeline {

struct GraphStages {
  std::vector<StageProgram> of_blocks;  // run once per block
  std::vector<StageProgram> of_site;    // run once

  std::vector<std::string> Names() const;
};

// The slice of each stage as text, by stage. `block_file` may be empty (then only the stages of the site are given).
// Missing files count as empty. UsageError names file and line of an unknown table or key, a wrong type or a value out
// of range.
std::map<std::string, std::string> ConfigSlices(const std::filesystem::path& site_file,
                                                const std::filesystem::path& block_file, const GraphStages& stages);

// `plumbline configure`: checks names, writes all slices to site/work/[BLOCK/]config/STAGE.toml and the states of the
// supplied files to site/work/.sources/FILE. What is unchanged keeps its time stamp.
void ConfigureSite(const std::filesystem::path& site, const GraphStages& stages);

}  // namespace pipeline
