// SPDX-License-Identifier: Apache-2.0
#include "stages/review/edit_store.h"

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "formats/block_edits_file.h"
#include "formats/edit_json.h"
#include "formats/edit_ledger.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "pipeline/site_edits.h"
#include "pipeline/site_layout.h"

namespace review {
namespace {

using formats::LedgerLine;
using formats::LedgerOperation;
using nlohmann::json;
using Outcome = Written::Outcome;

LedgerOperation OperationOf(const json& object) {
  const json name = object.value("op", json());
  for (const LedgerOperation operation : {LedgerOperation::kAdd, LedgerOperation::kModify, LedgerOperation::kRetire}) {
    if (name == Name(operation)) return operation;
  }
  throw formats::DataError("op = " + formats::JsonText(name) + ": must be add, modify or retire");
}

// A retirement has no geometry, so it is no edit to the reader of edits.
survey::MapEdit RetirementFromJson(const json& object) {
  survey::MapEdit edit;
  edit.uid = object.at("uid").get<std::string>();
  edit.revision = object.at("rev").get<int>();
  edit.who = object.at("who").get<std::string>();
  edit.when = object.at("when").get<std::string>();
  edit.why = object.value("why", "");
  edit.tool = object.value("tool", "");
  return edit;
}

LedgerLine LineFromJson(json object, const std::string& where) {
  const LedgerOperation operation = OperationOf(object);
  if (operation == LedgerOperation::kRetire) return {operation, RetirementFromJson(object), where};
  object.erase("op");
  return {operation, formats::EditFromJson(object, where), where};
}

// Where the last run has put the edits, and what it found about them.
struct LastRun {
  std::map<std::string, survey::AppliedEdit> applied;  // by uid, of the block that saw most of the edit
  json findings = json::array();
};

LastRun ReadLastRun(const std::filesystem::path& site) {
  LastRun last;
  for (const std::string& block : pipeline::BlocksOf(site)) {
    const std::filesystem::path file = site / "work" / block / "edits.json";
    if (!std::filesystem::exists(file)) continue;
    const survey::BlockEdits edits = formats::ReadBlockEdits(file);
    for (const survey::AppliedEdit& edit : edits.edits) {
      const auto [found, is_new] = last.applied.try_emplace(edit.edit.uid, edit);
      if (!is_new && found->second.anchored < edit.anchored) found->second = edit;
    }
    for (const survey::EditFinding& finding : edits.findings)
      last.findings.push_back({{"kind", Name(finding.kind)}, {"uids", finding.uids}, {"message", finding.message}});
  }
  return last;
}

json ForThePage(const survey::MapEdit& edit, const LastRun& last) {
  json object = formats::ToJson(edit);
  object["uid"] = edit.uid;
  object["rev"] = edit.revision;
  const auto applied = last.applied.find(edit.uid);
  const bool known = applied != last.applied.end() && applied->second.edit.revision == edit.revision;
  object["shown"] = formats::GeometryToJson(known ? applied->second.edit : edit);
  for (const char* inner : {"anchors", "beams"}) object.erase(inner);
  return object;
}

}  // namespace

json EditStore::All() const {
  const formats::Ledger ledger = formats::ReadLedger(pipeline::LedgerFile(site_));
  const LastRun last = ReadLastRun(site_);
  json edits = json::array();
  for (const survey::MapEdit& edit : ledger.Active()) edits.push_back(ForThePage(edit, last));
  return {{"head", ledger.head}, {"edits", edits}, {"findings", last.findings}};
}

Written EditStore::Append(const json& body, const std::string& seen) const {
  try {
    std::vector<LedgerLine> lines;
    for (const json& operation : body.at("operations"))
      lines.push_back(LineFromJson(operation, "edit " + std::to_string(lines.size() + 1)));
    if (lines.empty()) throw formats::DataError("operations: must not be empty");
    if (const std::optional<std::string> head = pipeline::RecordEdits(site_, lines, seen))
      return {Outcome::kDone, "", *head};
    return {Outcome::kStale, "somebody else has edited the map", formats::ReadLedger(pipeline::LedgerFile(site_)).head};
  } catch (const formats::DataError& error) {
    return {Outcome::kRefused, error.what(), formats::ReadLedger(pipeline::LedgerFile(site_)).head};
  }
}

}  // namespace review
