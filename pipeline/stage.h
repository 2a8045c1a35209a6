// SPDX-License-Identifier: Apache-2.0
//
// The runtime under every executable: a stage declares its inputs, outputs and options, then runs a function. Options
// come from the command line or from the stage's configuration file (the table of site.toml/block.toml that `plumbline
// configure` extracts); the command line wins. Unknown options and keys are errors.
//
//   int main(int argc, char** argv) {
//     pipeline::Stage stage("track", "Estimate the pose of every scan.", "plumbline track --session ...");
//     std::filesystem::path session_file, output;
//     survey::TrackOptions options;
//     stage.Input("session", &session_file, "session.sqlite of the block");
//     stage.Output("output", &output, "track.sqlite to write");
//     stage.Option("submap-length-m", &options.submap_length_m, "path length of a submap (m)", {.min = 0.5});
//     return stage.Run(argc, argv, [&](pipeline::StageRun& run) { ... });
//   }
//
// Exit statuses: 0 done, 1 bad data (formats::DataError), 2 bad usage (formats::UsageError), 3 our bug.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/errors.h"
#include "formats/provenance.h"

namespace pipeline {

std::string Version();

// A repeated input, NAME=FILE on the command line ("B1=work/B1/map.tif").
struct NamedFile {
  std::string name;
  std::filesystem::path file;
};

// How the content of an input counts in the provenance.
enum class Content {
  kBytes,                // every byte
  kTextWithoutComments,  // CSV, TOML: comments and blank lines do not count
  kParsed,  // not hashed by the runtime: the stage adds a digest of what it understood with StageRun::AddInput
};

struct Range {
  double min = std::numeric_limits<double>::lowest();
  double max = std::numeric_limits<double>::max();
};

// Progress line with rate and remaining time, on a terminal only; silent with --quiet.
class Progress {
 public:
  Progress(std::string program, std::string what, std::int64_t total, bool enabled);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void Advance(std::int64_t done);  // absolute count; cheap, prints at most five times a second

 private:
  std::string program_;
  std::string what_;
  std::int64_t total_;
  bool enabled_;
  bool printed_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

class StageRun {
 public:
  // Adds an input that the runtime does not hash by itself.
  void AddInput(formats::ProvenanceInput input) { inputs_.push_back(std::move(input)); }

  // The record for the artefacts of this run: hashes the declared inputs (once) and chains their records.
  const formats::Provenance& Provenance();

  // A record like Provenance() but with `inputs` instead of the declared ones (an extract that depends on part of an
  // input).
  formats::Provenance ProvenanceOf(std::vector<formats::ProvenanceInput> inputs) const;

  Progress Track(const std::string& what, std::int64_t total) const;
  void Message(const std::string& text);  // to stderr unless --quiet, and to the log
  void Warn(const std::string& text);     // to stderr and to the log, always
  int threads() const { return threads_; }

 private:
  friend class Stage;
  std::string stage_;
  std::map<std::string, std::string> options_;
  struct DeclaredInput {
    std::string role;
    std::filesystem::path file;
    Content content;
  };
  std::vector<DeclaredInput> declared_;
  std::vector<formats::ProvenanceInput> inputs_;
  std::optional<formats::Provenance> provenance_;
  int threads_ = 1;
  bool quiet_ = false;
  std::unique_ptr<std::ostream> log_;  // null without --log
};

class Stage {
 public:
  Stage(std::string name, std::string description, std::string example);
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  // Files. Inputs must exist before the run starts. OptionalInput leaves the path empty when not given.
  void Input(const std::string& name, std::filesystem::path* file, const std::string& help,
             Content content = Content::kBytes);
  void OptionalInput(const std::string& name, std::filesystem::path* file, const std::string& help,
                     Content content = Content::kBytes);
  void Inputs(const std::string& name, std::vector<std::filesystem::path>* files, const std::string& help,
              bool required, Content content = Content::kBytes);
  void NamedInputs(const std::string& name, std::vector<NamedFile>* files, const std::string& help, bool required,
                   Content content = Content::kBytes);
  void Output(const std::string& name, std::filesystem::path* path, const std::string& help);
  void OptionalOutput(const std::string& name, std::filesystem::path* path, const std::string& help);

  // Options that shape the output: command line, configuration key and provenance in one.
  void Option(const std::string& name, double* value, const std::string& help, Range range = {});
  // Without a value unless given; its default is then an empty text.
  void Option(const std::string& name, std::optional<double>* value, const std::string& help, Range range = {});
  void Option(const std::string& name, int* value, const std::string& help, Range range = {});
  void Option(const std::string& name, std::int64_t* value, const std::string& help, Range range = {});
  void Option(const std::string& name, bool* value, const std::string& help);
  void Option(const std::string& name, std::string* value, const std::string& help,
              const std::vector<std::string>& allowed = {});
  // Flags that do not shape the output (show, status): command line only.
  void Flag(const std::string& name, bool* value, const std::string& help);
  void Text(const std::string& name, std::string* value, const std::string& help,
            const std::vector<std::string>& allowed = {});
  void Positional(const std::string& name, std::filesystem::path* file, const std::string& help);

  int Run(int argc, char** argv, const std::function<void(StageRun&)>& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pipeline
