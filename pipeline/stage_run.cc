// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <ostream>

#include "formats/digest.h"
#include "formats/noted_digest.h"
#include "pipeline/stage.h"

namespace pipeline {
namespace {

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

double ThreadCpuSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

using Records = std::map<std::string, formats::ProvenanceRecord>;  // by id

// A file that counts with its content; the records of an artefact are added to those of all inputs.
formats::ProvenanceInput InputOf(const std::string& role, const std::filesystem::path& file, Content content,
                                 Records* ancestors) {
  if (content == Content::kTextWithoutComments)
    return {.role = role, .sha256 = formats::Sha256OfTextWithoutComments(file), .comments_ignored = true};
  const std::string extension = Lower(file.extension().string());
  const bool intermediate = extension == ".sqlite";
  formats::ProvenanceInput input{
      .role = role, .sha256 = intermediate ? formats::Sha256OfIntermediate(file) : formats::Sha256OfFile(file)};
  if (!intermediate && extension != ".tif" && extension != ".json") return input;
  const formats::Provenance chain = formats::ReadProvenance(file);
  input.record_id = chain.Own().Id();
  for (const formats::ProvenanceRecord& record : chain.records) ancestors->emplace(record.Id(), record);
  return input;
}

}  // namespace

std::string Version() { return PLUMBLINE_VERSION; }

const formats::Provenance& StageRun::Provenance() {
  if (provenance_) return *provenance_;
  const double began = ThreadCpuSeconds();
  std::vector<formats::ProvenanceInput> inputs = inputs_;
  Records ancestors;
  for (const DeclaredInput& declared : declared_) {
    if (declared.content != Content::kParsed)
      inputs.push_back(InputOf(declared.role, declared.file, declared.content, &ancestors));
  }
  formats::Provenance provenance = ProvenanceOf(std::move(inputs));
  for (auto& [id, record] : ancestors) provenance.records.push_back(std::move(record));
  provenance_ = std::move(provenance);
  if (log_) *log_ << "provenance: " << ThreadCpuSeconds() - began << " s of CPU" << std::endl;
  return *provenance_;
}

formats::Provenance StageRun::ProvenanceOf(std::vector<formats::ProvenanceInput> inputs) const {
  std::stable_sort(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) { return a.role < b.role; });
  return {.records = {{.stage = stage_, .version = Version(), .options = options_, .inputs = std::move(inputs)}}};
}

Progress StageRun::Track(const std::string& what, std::int64_t total) const {
  return {"plumbline-" + stage_, what, total, !quiet_};
}

void StageRun::Message(const std::string& text) {
  if (!quiet_) std::fprintf(stderr, "plumbline-%s: %s\n", stage_.c_str(), text.c_str());
  if (log_) *log_ << text << std::endl;
}

void StageRun::Warn(const std::string& text) {
  std::fprintf(stderr, "plumbline-%s: warning: %s\n", stage_.c_str(), text.c_str());
  if (log_) *log_ << "warning: " << text << std::endl;
}

}  // namespace pipeline
