// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_ledger.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/edit_json.h"
#include "formats/errors.h"
#include "formats/file_lock.h"
#include "formats/json_text.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using survey::MapEdit;

constexpr std::array kOperations = {LedgerOperation::kAdd, LedgerOperation::kModify, LedgerOperation::kRetire};
constexpr std::array kOfRetirement = {"op", "uid", "rev", "who", "when", "why", "tool"};

bool IsUid(const std::string& text) {
  static const std::regex kUid("[A-Za-z0-9_-]{1,64}");
  return std::regex_match(text, kUid);
}

bool IsTime(const std::string& text) {
  static const std::regex kTime(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)");
  return std::regex_match(text, kTime);
}

// What each line must fulfil given the lines before it; keeps the edits that are active and those that were.
class LedgerRules {
 public:
  // `where` begins every complaint.
  void Take(const LedgerLine& line, const std::string& where) {
    const MapEdit& edit = line.edit;
    const auto fail = [&](const std::string& rule) { throw DataError(where + ": " + rule); };
    if (!IsUid(edit.uid)) fail("uid = \"" + edit.uid + "\": must be 1 to 64 letters, digits, - and _");
    if (edit.who.empty()) fail("who is missing: every line says who decided it");
    if (!IsTime(edit.when)) fail("when = \"" + edit.when + "\": must be a time in UTC as 2026-11-28T10:15:00Z");
    const auto active = Find(edit.uid);
    if (line.operation == LedgerOperation::kAdd) {
      if (std::find(uids_.begin(), uids_.end(), edit.uid) != uids_.end())
        fail("uid = \"" + edit.uid + "\": is in the ledger already");
      if (edit.revision != 1) fail("rev = " + std::to_string(edit.revision) + ": an addition has 1");
      uids_.push_back(edit.uid);
      active_.push_back(edit);
      return;
    }
    if (active == active_.end()) fail("uid = \"" + edit.uid + "\": there is no such edit, or it was retired");
    if (edit.revision != active->revision + 1)
      fail("rev = " + std::to_string(edit.revision) + ": edit " + edit.uid + " is at revision " +
           std::to_string(active->revision) + ", so this must be the next");
    if (line.operation == LedgerOperation::kModify) {
      *active = edit;
    } else {
      retired_.push_back({*active, edit});
      active_.erase(active);
    }
  }

  int NextRevision(const std::string& uid) {
    const auto active = Find(uid);
    return active == active_.end() ? 1 : active->revision + 1;
  }

  const std::vector<MapEdit>& active() const { return active_; }
  const std::vector<RetiredEdit>& retired() const { return retired_; }

 private:
  std::vector<MapEdit>::iterator Find(const std::string& uid) {
    return std::find_if(active_.begin(), active_.end(), [&](const MapEdit& edit) { return edit.uid == uid; });
  }

  std::vector<std::string> uids_;  // of all that were ever added
  std::vector<MapEdit> active_;
  std::vector<RetiredEdit> retired_;
};

LedgerRules RulesAfter(const std::vector<LedgerLine>& lines) {
  LedgerRules rules;
  for (const LedgerLine& line : lines) rules.Take(line, "ledger");
  return rules;
}

LedgerOperation ReadOperation(const json& object, const std::string& where) {
  const json value = object.value("op", json());
  for (const LedgerOperation operation : kOperations) {
    if (value == Name(operation)) return operation;
  }
  throw DataError(where + ": op = " + JsonText(value).substr(0, 40) + ": must be add, modify or retire");
}

MapEdit ReadRetirement(const json& object, const std::string& where) {
  MapEdit edit;
  for (const auto& [key, value] : object.items()) {
    if (std::find(kOfRetirement.begin(), kOfRetirement.end(), key) == kOfRetirement.end())
      throw DataError(where + ": unknown member \"" + key + "\" of a retirement");
    if (key == "rev" ? !value.is_number_integer() : !value.is_string())
      throw DataError(where + ": " + key + " = " + JsonText(value).substr(0, 40) + ": expected " +
                      (key == "rev" ? "a number" : "a text"));
  }
  edit.uid = object.value("uid", "");
  edit.revision = object.value("rev", 1);
  edit.who = object.value("who", "");
  edit.when = object.value("when", "");
  edit.why = object.value("why", "");
  edit.tool = object.value("tool", "");
  return edit;
}

LedgerLine ReadLine(const std::string& text, const std::string& head, const std::string& where) {
  json object;
  try {
    object = ParsedJson(text);
  } catch (const json::exception&) {
    throw DataError(where + ": is not JSON; the file was cut off or written by hand?");
  }
  if (!object.is_object()) throw DataError(where + ": expected an object");
  if (object.value("prev", json()) != head)
    throw DataError(where + ": prev = " + JsonText(object.value("prev", json())) +
                    ": the chain is broken, the line before has the SHA-256 " + head +
                    "; a line was changed, removed or put in between: bring back the file as it was");
  object.erase("prev");
  LedgerLine line{.operation = ReadOperation(object, where)};
  if (line.operation == LedgerOperation::kRetire) {
    line.edit = ReadRetirement(object, where);
  } else {
    object.erase("op");
    line.edit = EditFromJson(object, where);
  }
  return line;
}

json LineToJson(const LedgerLine& line) {
  json object = ToJson(line.edit);
  if (line.operation == LedgerOperation::kRetire) {
    json kept;
    for (const char* key : kOfRetirement) {
      if (object.contains(key)) kept[key] = object[key];
    }
    object = kept;
  }
  object["op"] = Name(line.operation);
  return object;
}

struct CheckedLedger {
  Ledger ledger;
  LedgerRules rules;
  std::string text;
};

CheckedLedger ReadChecked(const fs::path& file) {
  CheckedLedger checked;
  checked.ledger.head = EmptyLedgerHead();
  if (!fs::exists(file)) return checked;
  checked.text = ReadWholeFile(file);
  if (!checked.text.empty() && checked.text.back() != '\n')
    throw DataError(file.string() + ": the last line has no end: the file was cut off");
  std::istringstream in(checked.text);
  for (std::string text; std::getline(in, text);) {
    const std::string where = file.string() + ":" + std::to_string(checked.ledger.lines.size() + 1);
    checked.ledger.lines.push_back(ReadLine(text, checked.ledger.head, where));
    checked.rules.Take(checked.ledger.lines.back(), where);
    checked.ledger.head = Sha256(text);
  }
  return checked;
}

}  // namespace

std::string EmptyLedgerHead() { return std::string(64, '0'); }

std::vector<MapEdit> Ledger::Active() const { return RulesAfter(lines).active(); }

std::vector<RetiredEdit> Ledger::Retired() const { return RulesAfter(lines).retired(); }

Ledger ReadLedger(const fs::path& file) { return ReadChecked(file).ledger; }

std::optional<std::string> AppendToLedger(const fs::path& file, std::vector<LedgerLine> lines,
                                          const std::optional<std::string>& expected_head) {
  const FileLock lock(file);
  CheckedLedger checked = ReadChecked(file);
  std::string& head = checked.ledger.head;
  if (expected_head && *expected_head != head) return std::nullopt;
  for (LedgerLine& line : lines) {
    if (line.operation == LedgerOperation::kAdd && line.edit.uid.empty())
      line.edit.uid = Sha256(head + JsonText(LineToJson(line))).substr(0, 12);
    if (line.edit.revision == 1) line.edit.revision = checked.rules.NextRevision(line.edit.uid);
    json object = LineToJson(line);
    object["prev"] = head;
    const std::string text = JsonText(object);
    const std::string where = line.where.empty() ? file.string() + ": line to append" : line.where;
    checked.rules.Take(ReadLine(text, head, where), where);
    checked.text += text + "\n";
    head = Sha256(text);
  }
  WriteFileAtomically(file, checked.text);
  return head;
}

}  // namespace formats
