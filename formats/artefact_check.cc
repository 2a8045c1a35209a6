// SPDX-License-Identifier: Apache-2.0
#include "formats/artefact_check.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "formats/artefact_file.h"
#include "formats/digest.h"
#include "formats/errors.h"
#include "formats/provenance.h"
#include "formats/raster_facts.h"

namespace formats {
namespace {

namespace fs = std::filesystem;

// An artefact of the site and its chain.
struct Member {
  FileReport* report = nullptr;
  Provenance provenance;
  std::string sha256;
};

// Every record that a record names as input must be there, and every record must be named or be the file's own.
std::vector<std::string> ProblemsOfChain(const Provenance& provenance) {
  std::vector<std::string> problems;
  std::set<std::string> present;
  std::set<std::string> named = {provenance.Own().Id()};
  for (const ProvenanceRecord& record : provenance.records) present.insert(record.Id());
  for (const ProvenanceRecord& record : provenance.records) {
    for (const ProvenanceInput& input : record.inputs) {
      if (input.record_id.empty()) continue;
      named.insert(input.record_id);
      if (!present.contains(input.record_id))
        problems.push_back("provenance: record " + ShortId(input.record_id) + " of the input " + input.role +
                           " of stage " + record.stage + " is missing");
    }
  }
  for (const ProvenanceRecord& record : provenance.records) {
    if (!named.contains(record.Id()))
      problems.push_back("provenance: record " + ShortId(record.Id()) + " of stage " + record.stage +
                         " is not an ancestor");
  }
  return problems;
}

void Break(FileReport& report, std::string note) {
  // The file is named once, at the line's start.
  const std::string prefix = report.file.string() + ": ";
  if (note.starts_with(prefix)) note.erase(0, prefix.size());
  report.state = FileState::kBroken;
  if (std::find(report.notes.begin(), report.notes.end(), note) == report.notes.end())
    report.notes.push_back(std::move(note));
}

bool HasArtefactExtension(const fs::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".sqlite" || extension == ".tif" || extension == ".json" || extension == ".jsonl";
}

// Fills the report; the provenance where there is one.
std::optional<Provenance> Examine(FileReport& report) {
  const fs::path& file = report.file;
  try {
    const FileKind kind = KindOfFile(file);
    if (kind == FileKind::kOther && !HasArtefactExtension(file)) {
      report.state = FileState::kOther;
      return std::nullopt;
    }
    if (kind == FileKind::kSqlite) {
      for (const std::string& problem : ExamineArtefact(file)) Break(report, problem);
      if (report.state == FileState::kBroken) return std::nullopt;
    }
    std::optional<Provenance> provenance = FindProvenance(file);
    if (!provenance) {
      report.state = FileState::kForeign;
      return std::nullopt;
    }
    if (kind == FileKind::kGeoTiff) ReadRasterFacts(file);
    const ProvenanceRecord& own = provenance->Own();
    report.origin = "made by " + own.stage + " " + own.version + ", record " + ShortId(own.Id());
    for (const std::string& problem : ProblemsOfChain(*provenance)) Break(report, problem);
    return provenance;
  } catch (const DataError& error) {
    Break(report, error.what());
    return std::nullopt;
  }
}

void AddFilesBelow(const fs::path& folder, std::vector<fs::path>& files) {
  for (auto entry = fs::recursive_directory_iterator(folder); entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory()) {
      if (name.starts_with(".") || name == "config" || name == "logs") entry.disable_recursion_pending();
    } else if (!name.starts_with(".")) {
      files.push_back(entry->path());
    }
  }
}

std::string StageOfRecord(const Provenance& provenance, const std::string& id) {
  for (const ProvenanceRecord& record : provenance.records) {
    if (record.Id() == id) return record.stage;
  }
  return "";
}

// The inputs of one artefact against the artefacts that are there. One run may write several files: one id, several
// digests.
void CheckInputs(Member& member, const std::map<std::string, std::set<std::string>>& digests_by_record,
                 const std::set<std::string>& stages_present) {
  FileReport& report = *member.report;
  for (const ProvenanceInput& input : member.provenance.Own().inputs) {
    if (input.record_id.empty()) continue;
    const auto found = digests_by_record.find(input.record_id);
    const std::string what = "its input " + input.role + " (record " + ShortId(input.record_id) + ")";
    if (found == digests_by_record.end()) {
      const std::string stage = StageOfRecord(member.provenance, input.record_id);
      if (stages_present.contains(stage)) {
        if (report.state == FileState::kWhole) report.state = FileState::kStale;
        report.notes.push_back(what + " has been made anew since, or is gone");
      } else {
        report.notes.push_back(what + " is not there to be compared");
      }
    } else if (!found->second.contains(input.sha256)) {
      Break(report,
            what + " has sha256 " + ShortId(*found->second.begin()) + ", but was read with " + ShortId(input.sha256));
    }
  }
}

}  // namespace

FileReport CheckFile(const fs::path& file) {
  FileReport report{.file = file};
  Examine(report);
  return report;
}

std::vector<FileReport> CheckSite(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* name : {"work", "out"}) {
    if (fs::is_directory(folder / name)) AddFilesBelow(folder / name, files);
  }
  if (files.empty()) AddFilesBelow(folder, files);
  std::sort(files.begin(), files.end());

  std::vector<FileReport> reports;
  reports.reserve(files.size());
  for (const fs::path& file : files) reports.push_back({.file = file});
  std::vector<Member> members;
  std::map<std::string, std::set<std::string>> digests_by_record;
  std::set<std::string> stages_present;
  for (FileReport& report : reports) {
    std::optional<Provenance> provenance = Examine(report);
    if (!provenance) continue;
    Member& member = members.emplace_back(Member{&report, *std::move(provenance), Sha256OfFile(report.file)});
    digests_by_record[member.provenance.Own().Id()].insert(member.sha256);
    stages_present.insert(member.provenance.Own().stage);
  }
  for (Member& member : members) CheckInputs(member, digests_by_record, stages_present);
  return reports;
}

}  // namespace formats
