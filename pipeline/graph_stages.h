// SPDX-License-Identifier: Apache-2.0
//
// The make graph as the programs that are not in it see it: where it lies and which stages it runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/site_config.h"

namespace pipeline {

// ../share/plumbline/plumbline.mk beside the folder of the running program.
std::filesystem::path GraphFile();

// Asks the stages' programs for their options; `cache` keeps their answers, empty: none.
GraphStages AskStages(const std::vector<std::string>& of_blocks, const std::vector<std::string>& of_site,
                      const std::filesystem::path& cache);

// The stages that the graph names.
GraphStages AskStagesOfGraph(const std::filesystem::path& cache);

}  // namespace pipeline
