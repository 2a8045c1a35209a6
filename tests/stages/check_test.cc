// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/artefact_check.h"
#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/raster_file.h"
#include "tests/support/command.h"
#include "tests/support/random_artefacts.h"
#include "tests/support/scratch_folder.h"

namespace {

namespace fs = std::filesystem;
using formats::CheckFile;
using formats::CheckSite;
using formats::FileReport;
using formats::FileState;
using formats::Provenance;
using formats::ProvenanceInput;
using test_support::CommandResult;
using test_support::RandomArtefacts;
using test_support::RunCommand;
using test_support::ScratchFolder;

// Provenance of a file that a stage made from artefacts.
Provenance MadeBy(const std::string& stage, const std::vector<fs::path>& inputs, const std::string& option = "") {
  Provenance provenance{.records = {{.stage = stage, .version = "0.1.0", .options = {{"option", option}}}}};
  std::map<std::string, formats::ProvenanceRecord> ancestors;
  for (const fs::path& input : inputs) {
    const Provenance chain = formats::ReadProvenance(input);
    provenance.records[0].inputs.push_back(
        {.role = input.stem().string(), .sha256 = formats::Sha256OfFile(input), .record_id = chain.Own().Id()});
    for (const auto& record : chain.records) ancestors.emplace(record.Id(), record);
  }
  for (auto& [id, record] : ancestors) provenance.records.push_back(record);
  return provenance;
}

// Its cells, which do not compress well, make most of the file.
survey::SiteRaster SmallRaster() {
  survey::SiteRaster raster{.cell_size_m = 0.5, .width = 80, .height = 60};
  for (int i = 0; i < 80 * 60; ++i) raster.log_odds.push_back(0.01F * static_cast<float>(i * i % 977));
  return raster;
}

// A site with one block from session to grid.
class CheckedSite : public testing::Test {
 protected:
  void SetUp() override {
    RandomArtefacts random(41);
    const auto stamps = random.ScanStamps(30);
    formats::WriteSession(block_ / "session.sqlite", random.Session(30, 40), MadeBy("ingest", {}));
    WriteTrack("first");
    const survey::Solution solution = random.Solution(30);
    formats::WriteSolution(block_ / "solution.sqlite", solution, stamps, MadeBy("adjust", {block_ / "track.sqlite"}));
    formats::WriteRaster(block_ / "grid.tif", SmallRaster(), {},
                         MadeBy("grid", {block_ / "session.sqlite", block_ / "solution.sqlite"}));
    formats::WriteFileAtomically(site_ / "out/site.png", "picture");
    formats::WriteFileAtomically(
        site_ / "out/seams.json",
        nlohmann::json{{"provenance", ToJson(MadeBy("stitch", {block_ / "grid.tif"}))}}.dump());
  }

  void WriteTrack(const std::string& option) {
    RandomArtefacts random(42);
    formats::WriteTrack(block_ / "track.sqlite", random.Track(30), random.ScanStamps(30),
                        MadeBy("track", {block_ / "session.sqlite"}, option));
  }

  FileReport ReportOf(const std::string& name) const {
    for (const FileReport& report : CheckSite(site_.path())) {
      if (report.file.filename() == name) return report;
    }
    return {};
  }

  const ScratchFolder site_;
  const fs::path block_ = site_ / "work/B1";
};

TEST_F(CheckedSite, WholeSitePasses) {
  const CommandResult result = RunCommand({"plumbline-check", site_.path()});
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("5 whole, 0 stale, 0 broken\n"), std::string::npos) << result.out;
  EXPECT_EQ(ReportOf("site.png").state, FileState::kOther);
  for (const char* name : {"session.sqlite", "track.sqlite", "solution.sqlite", "grid.tif"})
    EXPECT_EQ(RunCommand({"plumbline-check", block_ / name}).status, 0) << name;
}

TEST_F(CheckedSite, WhatWasMadeFromAnOlderInputIsStale) {
  WriteTrack("second");
  EXPECT_EQ(ReportOf("solution.sqlite").state, FileState::kStale);
  EXPECT_EQ(ReportOf("track.sqlite").state, FileState::kWhole);
  EXPECT_EQ(ReportOf("grid.tif").state, FileState::kWhole);
  const CommandResult result = RunCommand({"plumbline-check", site_.path()});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("        - its input track (record "), std::string::npos) << result.out;
  EXPECT_NE(result.err.find("0 files broken, 1 stale"), std::string::npos) << result.err;
}

TEST_F(CheckedSite, DeletedIntermediatesAreNotedOnly) {
  fs::remove(block_ / "track.sqlite");
  const FileReport report = ReportOf("solution.sqlite");
  EXPECT_EQ(report.state, FileState::kWhole);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_NE(report.notes[0].find("is not there to be compared"), std::string::npos);
}

TEST_F(CheckedSite, OtherBytesUnderTheSameRecordAreBroken) {
  RandomArtefacts random(43);
  formats::WriteTrack(block_ / "track.sqlite", random.Track(30), random.ScanStamps(30),
                      MadeBy("track", {block_ / "session.sqlite"}, "first"));
  EXPECT_EQ(ReportOf("solution.sqlite").state, FileState::kBroken);
}

TEST_F(CheckedSite, DamageIsFoundInEveryForm) {
  for (const fs::path& file : {block_ / "session.sqlite", block_ / "grid.tif", site_ / "out/seams.json"}) {
    const std::string bytes = formats::ReadWholeFile(file);
    formats::WriteFileAtomically(file, bytes.substr(0, bytes.size() * 3 / 4));
    EXPECT_EQ(CheckFile(file).state, FileState::kBroken) << file;
    const CommandResult result = RunCommand({"plumbline-check", file});
    EXPECT_EQ(result.status, 1);
    EXPECT_TRUE(result.err.starts_with("plumbline-check: " + file.string() + ": ")) << result.err;
    formats::WriteFileAtomically(file, bytes);
  }
}

TEST_F(CheckedSite, ForeignFilesAreListedAndDoNotFail) {
  formats::WriteFileAtomically(site_ / "out/notes.json", "{\"author\": \"a surveyor\"}");
  EXPECT_EQ(ReportOf("notes.json").state, FileState::kForeign);
  EXPECT_EQ(RunCommand({"plumbline-check", site_.path()}).status, 0);
  EXPECT_EQ(RunCommand({"plumbline-check", site_ / "out/notes.json"}).status, 1);
}

TEST_F(CheckedSite, AForgedRecordIsBroken) {
  nlohmann::json json = nlohmann::json::parse(formats::ReadWholeFile(site_ / "out/seams.json"));
  json["provenance"][0]["options"]["option"] = "another";
  formats::WriteFileAtomically(site_ / "out/seams.json", json.dump());
  const FileReport forged = CheckFile(site_ / "out/seams.json");
  EXPECT_EQ(forged.state, FileState::kBroken);
  EXPECT_NE(forged.notes.at(0).find("its id does not match its content"), std::string::npos);
}

TEST_F(CheckedSite, AnIncompleteChainIsBroken) {
  nlohmann::json json = nlohmann::json::parse(formats::ReadWholeFile(site_ / "out/seams.json"));
  json["provenance"].erase(2);
  formats::WriteFileAtomically(site_ / "out/seams.json", json.dump());
  EXPECT_EQ(CheckFile(site_ / "out/seams.json").state, FileState::kBroken);
}

TEST(Check, NothingToCheckFails) {
  const ScratchFolder folder;
  EXPECT_EQ(RunCommand({"plumbline-check", folder.path()}).status, 1);
  EXPECT_EQ(RunCommand({"plumbline-check", folder / "none.sqlite"}).status, 1);
  EXPECT_EQ(RunCommand({"plumbline-check"}).status, 2);
}

}  // namespace
