// SPDX-License-Identifier: Apache-2.0
#include "stages/review/import_review.h"

#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "stages/review/answer_store.h"
#include "stages/review/edit_store.h"

namespace review {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json ReadSaved(const fs::path& file) {
  json saved;
  try {
    saved = formats::ParsedJson(formats::ReadWholeFile(file));
  } catch (const json::parse_error& error) {
    throw formats::DataError(file.string() + ": is not JSON: " + error.what());
  }
  const bool ours = saved.is_object() && saved.value("format", json()) == "plumbline-review" &&
                    saved.value("format_version", json()) == 1 && saved.contains("answers") &&
                    saved["answers"].is_array() && saved.contains("operations") && saved["operations"].is_array();
  if (!ours) throw formats::DataError(file.string() + ": was not saved by a review page (format plumbline-review 1)");
  return saved;
}

void Require(const Written& written, const std::string& where) {
  if (written.outcome != Written::Outcome::kDone) throw formats::DataError(where + ": " + written.message);
}

// An answer that is there already, word for word, was imported before.
void RequireUnanswered(const json& saved, const json& present, const fs::path& file) {
  for (const json& entry : saved["answers"]) {
    const std::string block = entry.at("block");
    const std::string stamp = entry.at("answer").at("stamp_ns");
    const json now = present.value(block, json::object()).value(stamp, json::object());
    if (now.value("tag", "") == entry.value("seen", "") || now.value("answer", json()) == entry["answer"]) continue;
    throw formats::DataError(file.string() + ": block " + block + ", stamp_ns = " + stamp +
                             ": somebody else has answered for this scan since; remove one of the two");
  }
}

}  // namespace

std::string ImportReview(const fs::path& site, const fs::path& file) {
  const json saved = ReadSaved(file);
  try {
    AnswerStore answers(site);
    const json present = answers.All();
    RequireUnanswered(saved, present, file);
    for (const json& entry : saved["answers"]) {
      const std::string block = entry["block"];
      const std::string stamp = entry["answer"]["stamp_ns"];
      const std::string tag = present.value(block, json::object()).value(stamp, json::object()).value("tag", "");
      Require(answers.Put(block, stamp, entry["answer"], tag), file.string() + ": answer " + stamp);
    }
    const EditStore edits(site);
    if (!saved["operations"].empty())
      Require(edits.Append({{"operations", saved["operations"]}}, edits.All()["head"]), file.string());
  } catch (const json::exception& error) {
    throw formats::DataError(file.string() + ": " + error.what());
  }
  return "took over " + std::to_string(saved["answers"].size()) + " answers and " +
         std::to_string(saved["operations"].size()) + " edits";
}

}  // namespace review
