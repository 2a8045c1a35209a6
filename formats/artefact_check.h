// SPDX-License-Identifier: Apache-2.0
//
// Are artefacts whole, and do the files of a site belong together?
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace formats {

enum class FileState {
  kWhole,
  kStale,    // whole, but one of its inputs has been made anew since
  kBroken,   // damaged, or its provenance contradicts itself or the site
  kForeign,  // of an artefact's form, but not Plumbline's
  kOther,    // carries no provenance by its nature: PNG, world file, HTML, ...
};

constexpr std::string_view Name(FileState state) {
  switch (state) {
    case FileState::kWhole:
      return "whole";
    case FileState::kStale:
      return "stale";
    case FileState::kBroken:
      return "BROKEN";
    case FileState::kForeign:
      return "foreign";
    case FileState::kOther:
      return "other";
  }
  return "";
}

struct FileReport {
  std::filesystem::path file;
  FileState state = FileState::kWhole;
  std::string origin;              // stage, version and record that made it
  std::vector<std::string> notes;  // what is wrong and why; for whole files, what could not be checked
};

// One file by itself: every byte read, format version, checksums, provenance records and their chain.
FileReport CheckFile(const std::filesystem::path& file);

// Every file below `folder`/work and `folder`/out (or below `folder` when it has neither), in order of names, and
// their inputs against each other. Hidden files, logs and configurations are left out.
std::vector<FileReport> CheckSite(const std::filesystem::path& folder);

}  // namespace formats
