// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_config.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "pipeline/file_state.h"
#include "pipeline/nearest.h"
#include "pipeline/site_layout.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;
using formats::UsageError;

// Values by key, as TOML text.
using Values = std::map<std::string, std::string>;

struct ConfigTable {
  std::string name;
  std::vector<const StageProgram*> readers;  // stages that its keys may go to
};

std::string At(const fs::path& file, const toml::source_region& source) {
  return file.string() + ":" + std::to_string(source.begin.line) + ": ";
}

toml::table Parse(const fs::path& file) {
  if (file.empty() || !fs::exists(file)) return {};
  try {
    return toml::parse(formats::ReadWholeFile(file), file.string());
  } catch (const toml::parse_error& error) {
    throw UsageError(At(file, error.source()) + std::string(error.description()));
  }
}

bool HasType(const toml::node& node, const std::string& type) {
  if (type == "number") return node.is_number();
  if (type == "integer") return node.is_integer();
  if (type == "boolean") return node.is_boolean();
  return node.is_string();
}

void CheckValue(const toml::node& node, const OptionInfo& option, const std::string& where) {
  if (!HasType(node, option.type)) throw UsageError(where + "expected a value of type " + option.type);
  if (node.is_number()) {
    const double value = *node.value<double>();
    const bool low = !option.min.empty() && !(value >= std::stod(option.min));
    const bool high = !option.max.empty() && !(value <= std::stod(option.max));
    if (low || high) throw UsageError(where + "must be at " + (low ? "least " + option.min : "most " + option.max));
  }
  const std::string text = node.value<std::string>().value_or("");
  const auto& allowed = option.allowed;
  if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), text) == allowed.end()) {
    throw UsageError(where + "\"" + text + "\" must be one of " + Joined(allowed));
  }
}

std::vector<std::string> KeysOf(const ConfigTable& table) {
  std::vector<std::string> keys;
  for (const StageProgram* reader : table.readers) {
    for (const OptionInfo& option : reader->options) keys.push_back(option.key);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

void CheckTable(const fs::path& file, const ConfigTable& table, const toml::table& content) {
  for (const auto& [toml_key, node] : content) {
    const std::string key(toml_key.str());
    const std::string where = At(file, node.source()) + "[" + table.name + "] " + key + ": ";
    bool known = false;
    for (const StageProgram* reader : table.readers) {
      const OptionInfo* option = reader->Find(key);
      if (option == nullptr) continue;
      known = true;
      CheckValue(node, *option, where);
    }
    if (!known) throw UsageError(where + "unknown key" + Suggestion(key, KeysOf(table)));
  }
}

// Reads and checks a whole file: values by table.
std::map<std::string, toml::table> ReadTables(const fs::path& file, const std::vector<ConfigTable>& tables) {
  std::map<std::string, toml::table> contents;
  std::vector<std::string> names;
  for (const ConfigTable& table : tables) names.push_back(table.name);
  for (const auto& [toml_name, node] : Parse(file)) {
    const std::string name(toml_name.str());
    const std::string where = At(file, node.source());
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string what =
          node.is_table() ? "[" + name + "]: unknown table" : name + ": a key outside of any table";
      throw UsageError(where + what + Suggestion(name, names));
    }
    if (!node.is_table()) throw UsageError(where + name + ": expected a table, [" + name + "]");
    CheckTable(file, tables[static_cast<std::size_t>(found - names.begin())], *node.as_table());
    contents.emplace(name, *node.as_table());
  }
  return contents;
}

std::vector<const StageProgram*> Pointers(const std::vector<StageProgram>& programs) {
  std::vector<const StageProgram*> pointers;
  for (const StageProgram& program : programs) pointers.push_back(&program);
  return pointers;
}

std::vector<ConfigTable> TablesOfSite(const GraphStages& stages) {
  std::vector<const StageProgram*> all = Pointers(stages.of_blocks);
  const std::vector<const StageProgram*> of_site = Pointers(stages.of_site);
  all.insert(all.end(), of_site.begin(), of_site.end());
  std::vector<ConfigTable> tables = {{"site", all}, {"sensors", all}};
  for (const StageProgram* stage : all) tables.push_back({stage->stage, {stage}});
  return tables;
}

std::vector<ConfigTable> TablesOfBlock(const GraphStages& stages) {
  std::vector<ConfigTable> tables = {{"sensors", Pointers(stages.of_blocks)}};
  for (const StageProgram& stage : stages.of_blocks) tables.push_back({stage.stage, {&stage}});
  return tables;
}

// As TOML; numbers in their shortest form.
std::string TextOf(const toml::node& node) {
  std::ostringstream text;
  if (node.is_floating_point()) {
    std::array<char, 32> buffer{};
    const double value = *node.value<double>();
    text.write(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr - buffer.data());
  } else {
    node.visit([&](const auto& value) { text << value; });
  }
  return text.str();
}

void Take(const std::map<std::string, toml::table>& tables, const std::string& name, const StageProgram& stage,
          Values* values) {
  const auto found = tables.find(name);
  if (found == tables.end()) return;
  for (const auto& [key, node] : found->second) {
    if (stage.Find(std::string(key.str())) == nullptr) continue;
    (*values)[std::string(key.str())] = TextOf(node);
  }
}

std::string SliceText(const StageProgram& stage, const Values& values) {
  std::string text = "# Written by `plumbline configure`; edit site.toml or block.toml instead.\n# plumbline-" +
                     stage.stage + " " + stage.identity + "\n";
  for (const auto& [key, value] : values) text.append(key).append(" = ").append(value).append("\n");
  return text;
}

void WriteSlices(const fs::path& folder, const std::map<std::string, std::string>& slices) {
  for (const auto& [stage, text] : slices) formats::WriteFileAtomically(folder / (stage + ".toml"), text);
}

void WriteSourceStates(const fs::path& site) {
  for (const fs::path& file : SuppliedFiles(site)) {
    formats::WriteFileAtomically(site / "work" / ".sources" / file, FileState(site / file) + "\n");
  }
}

}  // namespace

std::vector<std::string> GraphStages::Names() const {
  std::vector<std::string> names;
  for (const StageProgram& stage : of_blocks) names.push_back(stage.stage);
  for (const StageProgram& stage : of_site) names.push_back(stage.stage);
  return names;
}

std::map<std::string, std::string> ConfigSlices(const fs::path& site_file, const fs::path& block_file,
                                                const GraphStages& stages) {
  const bool for_block = !block_file.empty();
  const auto site_tables = ReadTables(site_file, TablesOfSite(stages));
  const auto block_tables = for_block ? ReadTables(block_file, TablesOfBlock(stages)) : decltype(site_tables){};
  std::map<std::string, std::string> slices;
  for (const StageProgram& stage : for_block ? stages.of_blocks : stages.of_site) {
    Values values;
    for (const auto& [tables, names] :
         {std::pair{&site_tables, std::vector<std::string>{"site", "sensors", stage.stage}},
          std::pair{&block_tables, std::vector<std::string>{"sensors", stage.stage}}}) {
      for (const std::string& name : names) Take(*tables, name, stage, &values);
    }
    slices[stage.stage] = SliceText(stage, values);
  }
  return slices;
}

void ConfigureSite(const fs::path& site, const GraphStages& stages) {
  const fs::path site_file = (site / "site.toml").lexically_normal();
  if (!fs::exists(site_file)) {
    throw DataError(site_file.string() + ": no such file; is this a site's folder? (plumbline new makes one)");
  }
  const std::vector<std::string> blocks = BlocksOf(site);
  if (blocks.empty()) throw DataError((site / "blocks").lexically_normal().string() + ": no block in it");
  for (const std::string& block : blocks) {
    CheckBlockName(block, stages.Names());
    const fs::path folder = (site / "blocks" / block).lexically_normal();
    if (!fs::is_directory(folder / "raw") || fs::is_empty(folder / "raw")) {
      throw DataError((folder / "raw").string() + ": no field data in it");
    }
    WriteSlices(site / "work" / block / "config", ConfigSlices(site_file, folder / "block.toml", stages));
  }
  WriteSlices(site / "work" / "config", ConfigSlices(site_file, {}, stages));
  WriteSourceStates(site);
  for (const char* folder : {"work/.stamps/begun", "logs"}) fs::create_directories(site / folder);
}

}  // namespace pipeline
