// SPDX-License-Identifier: Apache-2.0
#include "pipeline/site_layout.h"

#include <algorithm>
#include <cctype>

#include "formats/errors.h"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using formats::DataError;
using formats::UsageError;

constexpr const char* kReserved[] = {"all", "graph", "FORCE", "work", "out", "logs", "blocks", "control", "edits"};

bool IsPlain(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x80 || std::isalnum(byte) != 0 || std::string("_.-+,@").find(c) != std::string::npos;
}

void Collect(const fs::path& site, const fs::path& folder, std::vector<fs::path>* files) {
  if (!fs::is_directory(site / folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(site / folder)) {
    const fs::path file = folder / entry.path().filename();
    const std::string name = file.filename().string();
    if (name.starts_with(".")) continue;
    if (!IsPlainName(name)) {
      throw DataError((site / file).lexically_normal().string() +
                      ": rename it, please: only letters, digits and _ . - + , @ can be handled in names");
    }
    if (!entry.exists())
      throw DataError((site / file).lexically_normal().string() + ": the linked file does not exist");
    if (entry.is_directory()) {
      Collect(site, file, files);
    } else {
      files->push_back(file);
    }
  }
}

}  // namespace

bool IsPlainName(const std::string& name) {
  return !name.empty() && name[0] != '-' && std::all_of(name.begin(), name.end(), IsPlain);
}

void CheckBlockName(const std::string& name, const std::vector<std::string>& stages) {
  const bool plain = !name.empty() && std::isalnum(static_cast<unsigned char>(name[0])) != 0 &&
                     std::all_of(name.begin(), name.end(),
                                 [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  if (!plain) {
    throw UsageError("block name \"" + name + "\": use letters, digits, _ and -, beginning with a letter or digit");
  }
  const bool reserved = std::find(std::begin(kReserved), std::end(kReserved), name) != std::end(kReserved) ||
                        std::find(stages.begin(), stages.end(), name) != stages.end();
  if (reserved) throw UsageError("block name \"" + name + "\": this word has a meaning for `make`; choose another");
}

std::vector<std::string> BlocksOf(const fs::path& site) {
  std::vector<std::string> blocks;
  if (!fs::is_directory(site / "blocks")) return blocks;
  for (const fs::directory_entry& entry : fs::directory_iterator(site / "blocks")) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && !name.starts_with(".")) blocks.push_back(name);
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

std::vector<fs::path> SuppliedFiles(const fs::path& site) {
  std::vector<fs::path> files;
  for (const char* folder : {"control", "blocks", "edits", "delivered"}) Collect(site, folder, &files);
  if (fs::exists(site / "accuracy-classes.toml")) files.push_back("accuracy-classes.toml");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace pipeline
