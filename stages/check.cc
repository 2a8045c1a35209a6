// SPDX-License-Identifier: Apache-2.0
//
// plumbline-check: integrity, version and provenance of one artefact or of all files of a site; a line per file.
#include <algorithm>
#include <iostream>

#include "formats/artefact_check.h"
#include "pipeline/stage.h"

namespace {

void Print(const formats::FileReport& report) {
  std::string state(Name(report.state));
  state.resize(8, ' ');
  std::cout << state << report.file.string();
  if (!report.origin.empty()) std::cout << "  " << report.origin;
  std::cout << "\n";
  for (const std::string& note : report.notes) std::cout << "        - " << note << "\n";
}

void CheckOne(const std::filesystem::path& file) {
  const formats::FileReport report = formats::CheckFile(file);
  Print(report);
  if (report.state != formats::FileState::kWhole)
    throw formats::DataError(file.string() + ": " +
                             (report.notes.empty() ? "not one of Plumbline's artefacts" : report.notes.front()));
}

void CheckAll(const std::filesystem::path& site) {
  const std::vector<formats::FileReport> reports = formats::CheckSite(site);
  const auto count = [&](formats::FileState state) {
    return std::count_if(reports.begin(), reports.end(), [&](const auto& report) { return report.state == state; });
  };
  for (const formats::FileReport& report : reports) Print(report);
  const auto whole = count(formats::FileState::kWhole);
  const auto stale = count(formats::FileState::kStale);
  const auto broken = count(formats::FileState::kBroken);
  std::cout << whole << " whole, " << stale << " stale, " << broken << " broken\n";
  if (stale + broken > 0)
    throw formats::DataError(site.string() + ": " + std::to_string(broken) + " files broken, " + std::to_string(stale) +
                             " stale; `plumbline run` makes stale files anew, broken ones "
                             "after they are deleted");
  if (whole == 0) throw formats::DataError(site.string() + ": no artefact there");
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("check", "Check the integrity, format version and provenance of an artefact or of a site.",
                        "plumbline check out/certificate.json");
  std::filesystem::path path;
  stage.Positional("FILE|SITE", &path, "artefact (.sqlite, .tif or .json) or folder of a site");
  return stage.Run(argc, argv, [&](pipeline::StageRun&) {
    if (std::filesystem::is_directory(path)) {
      CheckAll(path);
    } else {
      CheckOne(path);
    }
  });
}
