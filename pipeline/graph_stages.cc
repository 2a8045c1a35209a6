// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph_stages.h"

#include <sstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "pipeline/stage_program.h"
#include "pipeline/subprocess.h"
#include "pipeline/words.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;

// The two lists of stages live in plumbline.mk alone; it hands them to `plumbline configure`. Others read them there.
std::vector<std::string> ListInGraph(const fs::path& graph, const std::string& variable) {
  std::istringstream lines(formats::ReadWholeFile(graph));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(variable + " := ")) continue;
    return Words(line.substr(variable.size() + 4));
  }
  throw DataError(graph.string() + ": no " + variable);
}

}  // namespace

fs::path GraphFile() {
  fs::path graph = OwnFolder().parent_path() / "share" / "plumbline" / "plumbline.mk";
  if (!fs::exists(graph)) throw DataError(graph.string() + ": no such file; is Plumbline whole?");
  return graph;
}

GraphStages AskStages(const std::vector<std::string>& of_blocks, const std::vector<std::string>& of_site,
                      const fs::path& cache) {
  const auto ask = [&](const std::vector<std::string>& names) {
    std::vector<StageProgram> programs;
    for (const std::string& name : names) programs.push_back(AskStageProgram(name, OwnFolder(), cache));
    return programs;
  };
  return {ask(of_blocks), ask(of_site)};
}

GraphStages AskStagesOfGraph(const fs::path& cache) {
  const fs::path graph = GraphFile();
  return AskStages(ListInGraph(graph, "plumbline.block-stages"), ListInGraph(graph, "plumbline.site-stages"), cache);
}

}  // namespace pipeline
