// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_template.h"

#include <algorithm>
#include <set>

#include "pipeline/nearest.h"
#include "pipeline/words.h"

namespace pipeline {
namespace {

// Keys that belong to the site as a whole and therefore stand in [site], not in a stage's table.
const std::set<std::string> kSiteKeys = {"crs", "cell-size-m", "accuracy-class-m", "joint"};

std::string AsToml(const OptionInfo& option, const std::string& value) {
  return option.type == "string" ? "\"" + value + "\"" : value;
}

std::string Explained(const OptionInfo& option) {
  std::string allowed;
  for (const std::string& word : option.allowed) allowed += (allowed.empty() ? "" : ", ") + ("\"" + word + "\"");
  const bool listed = option.allowed.empty() || option.help.find(option.allowed.back()) != std::string::npos;
  return option.help + (listed ? "" : " (" + allowed + ")");
}

std::string Line(const OptionInfo& option, const std::string& prefix, const std::string& value) {
  return PaddedTo(44, prefix + option.key + " = " + AsToml(option, value)) + "  # " + Explained(option) + "\n";
}

std::string CommentedLine(const OptionInfo& option) { return Line(option, "# ", option.default_text); }

// What ingest wants to know is the instruments' set-up.
std::string TableOf(const StageProgram& stage) { return stage.stage == "ingest" ? "sensors" : stage.stage; }

bool AllKeysAreTheSites(const StageProgram& stage) {
  return std::all_of(stage.options.begin(), stage.options.end(),
                     [](const OptionInfo& option) { return kSiteKeys.contains(option.key); });
}

std::string StageTable(const StageProgram& stage) {
  if (AllKeysAreTheSites(stage)) return "";
  std::string text = "\n[" + TableOf(stage) + "]\n";
  for (const OptionInfo& option : stage.options) {
    if (!kSiteKeys.contains(option.key)) text += CommentedLine(option);
  }
  return text;
}

// The keys of [site], each once, from the first stage that has it.
std::string SiteTable(const std::string& crs, const GraphStages& stages) {
  std::string text = "[site]\n";
  std::set<std::string> written;
  for (const std::vector<StageProgram>* group : {&stages.of_blocks, &stages.of_site}) {
    for (const StageProgram& stage : *group) {
      for (const OptionInfo& option : stage.options) {
        if (!kSiteKeys.contains(option.key) || !written.insert(option.key).second) continue;
        const bool given = option.key == "crs" && !crs.empty();
        text += given ? Line(option, "", crs) : CommentedLine(option);
      }
    }
  }
  return text;
}

}  // namespace

std::string MakefileText() {
  return "# The graph comes with Plumbline, which must be on PATH here; `plumbline run` sees to that by itself.\n"
         "include $(shell plumbline --graph)\n";
}

std::string SiteToml(const std::string& crs, const std::string& control_order, const GraphStages& stages) {
  std::string text =
      "# The site's configuration. A key that is commented out has the value shown: its default.\n"
      "# [site] and [sensors] reach every stage that knows the key; a table named after a stage reaches that stage.\n"
      "# blocks/NAME/block.toml replaces values for one block. A change re-runs only what depends on it.\n\n" +
      SiteTable(crs, stages);
  for (const StageProgram& stage : stages.of_blocks) text += StageTable(stage);
  for (const StageProgram& stage : stages.of_site) {
    std::string table = StageTable(stage);
    if (const OptionInfo* order = stage.Find("control-order"); order != nullptr && !control_order.empty()) {
      const std::string commented = CommentedLine(*order);
      table.replace(table.find(commented), commented.size(), Line(*order, "", control_order));
    }
    text += table;
  }
  return text;
}

std::string BlockToml(const std::string& block, const GraphStages& stages) {
  std::vector<std::string> names;
  for (const StageProgram& stage : stages.of_blocks) names.push_back(stage.stage);
  return "# What is different in block " + block +
         ": values here replace those of site.toml for this block alone.\n"
         "# Tables: [sensors] for the instruments, or a stage's name (" +
         Joined(names) + "); keys as in site.toml.\n\n[sensors]\n";
}

}  // namespace pipeline
