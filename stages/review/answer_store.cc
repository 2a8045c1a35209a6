// SPDX-License-Identifier: Apache-2.0
#include "stages/review/answer_store.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/answers_file.h"
#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "pipeline/site_layout.h"
#include "stages/review/text.h"

namespace review {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Outcome = Written::Outcome;

constexpr std::size_t kMaxDigits = 19;  // of a stamp

// Browsers read numbers as doubles, which do not hold a stamp: on the page they are texts, on disk integers.
bool IsStampKey(const std::string& key) { return key == "stamp_ns" || key.ends_with("_stamp_ns") || key == "end_ns"; }

void StampsToTexts(json* value) {
  if (!value->is_structured()) return;
  for (const auto& item : value->items()) {
    if (IsStampKey(item.key()) && item.value().is_number_integer()) {
      item.value() = std::to_string(item.value().get<std::int64_t>());
    } else {
      StampsToTexts(&item.value());
    }
  }
}

bool IsStamp(const std::string& text) {
  const std::size_t sign = text.starts_with("-") ? 1 : 0;
  return text.size() > sign && text.size() - sign < kMaxDigits + 1 &&
         text.find_first_not_of("0123456789", sign) == std::string::npos;
}

void StampsToIntegers(json* value) {
  if (!value->is_structured()) return;
  for (const auto& item : value->items()) {
    if (IsStampKey(item.key()) && item.value().is_string() && IsStamp(item.value().get<std::string>())) {
      item.value() = formats::ParsedJson(item.value().get<std::string>());
    } else {
      StampsToIntegers(&item.value());
    }
  }
}

std::vector<fs::path> FilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".json") && !name.starts_with(".")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string StampOf(const json& answer) {
  const json stamp = answer.is_object() ? answer.value("stamp_ns", json()) : json();
  return stamp.is_string() ? stamp.get<std::string>() : "";
}

std::string TagOf(const std::string& bytes) { return formats::Sha256(bytes).substr(0, 16); }

}  // namespace

json AnswerStore::All() const {
  json all = json::object();
  for (const std::string& block : pipeline::BlocksOf(site_)) {
    all[block] = json::object();
    for (const fs::path& file : FilesIn(site_ / "blocks" / block / "answers")) {
      const std::string bytes = formats::ReadWholeFile(file);
      json answer = formats::JsonOrDiscarded(bytes);  // `track` tells what is wrong with one that is no JSON
      StampsToTexts(&answer);
      if (!StampOf(answer).empty()) all[block][StampOf(answer)] = {{"tag", TagOf(bytes)}, {"answer", answer}};
    }
  }
  return all;
}

bool AnswerStore::HasBlock(const std::string& block) const {
  const std::vector<std::string> blocks = pipeline::BlocksOf(site_);
  return std::find(blocks.begin(), blocks.end(), block) != blocks.end();
}

AnswerStore::Entry AnswerStore::Find(const std::string& block, const std::string& stamp) const {
  const fs::path folder = site_ / "blocks" / block / "answers";
  for (const fs::path& file : FilesIn(folder)) {
    const std::string bytes = formats::ReadWholeFile(file);
    json answer = formats::JsonOrDiscarded(bytes);
    StampsToTexts(&answer);
    if (StampOf(answer) == stamp) return {file, TagOf(bytes)};
  }
  return {folder / (stamp + ".json"), ""};
}

// All answers of the block as they would be then, by the reader that `track` and `adjust` use.
void AnswerStore::Check(const std::string& block, const fs::path& file, const fs::path& in_place_of) const {
  std::vector<fs::path> files = {file};
  for (const fs::path& other : FilesIn(site_ / "blocks" / block / "answers")) {
    if (other != in_place_of) files.push_back(other);
  }
  const fs::path track = site_ / "work" / block / "track.sqlite";
  if (!fs::exists(track)) throw formats::DataError(track.string() + ": no such file: plumbline run first");
  formats::ReadAnswers(files, survey::ClockStamps(formats::ReadScanStamps(track)));
}

Written AnswerStore::Put(const std::string& block, const std::string& stamp, json answer, const std::string& seen) {
  if (!HasBlock(block)) return {Outcome::kRefused, block + ": no such block", ""};
  if (!IsStamp(stamp) || StampOf(answer) != stamp)
    return {Outcome::kRefused, "stamp_ns: must be the stamp " + stamp + " as a text", ""};
  const std::lock_guard lock(mutex_);
  const Entry entry = Find(block, stamp);
  if (entry.tag != seen) return {Outcome::kStale, "somebody else has answered for this scan", entry.tag};
  StampsToIntegers(&answer);
  const std::string bytes = answer.dump(1) + "\n";
  formats::AtomicFile file(entry.file);
  std::ofstream(file.temporary(), std::ios::binary) << bytes;
  try {
    Check(block, file.temporary(), entry.file);
    file.Commit();
  } catch (const formats::DataError& error) {
    return {Outcome::kRefused, ReplacedAll(error.what(), file.temporary().string(), "answer"), entry.tag};
  }
  return {Outcome::kDone, "", TagOf(bytes)};
}

Written AnswerStore::Remove(const std::string& block, const std::string& stamp, const std::string& seen) {
  if (!HasBlock(block)) return {Outcome::kRefused, block + ": no such block", ""};
  const std::lock_guard lock(mutex_);
  const Entry entry = Find(block, stamp);
  if (entry.tag != seen) return {Outcome::kStale, "somebody else has changed this answer", entry.tag};
  if (!entry.tag.empty()) fs::remove(entry.file);
  return {};
}

}  // namespace review
