// SPDX-License-Identifier: Apache-2.0
//
// The ledger of a site's map edits, edits/ledger.jsonl: append-only, a JSON object a line, each with the SHA-256 of the
// line before it, so that a line that was changed, removed or put in between is noticed. README.md, "Map edits".
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "survey/edits/map_edit.h"

namespace formats {

enum class LedgerOperation { kAdd, kModify, kRetire };

constexpr std::string_view Name(LedgerOperation operation) {
  switch (operation) {
    case LedgerOperation::kAdd:
      return "add";
    case LedgerOperation::kModify:
      return "modify";
    case LedgerOperation::kRetire:
      return "retire";
  }
  return "";
}

// Of a retirement only uid, revision, who, when, why and tool of the edit count.
struct LedgerLine {
  LedgerOperation operation = LedgerOperation::kAdd;
  survey::MapEdit edit;
  std::string where{};  // begins complaints about it: "drawn.geojson: feature 2"
};

// An edit that was taken back: as it was last, and the retirement with its who, when and why.
struct RetiredEdit {
  survey::MapEdit edit;
  survey::MapEdit retirement;
};

struct Ledger {
  std::vector<LedgerLine> lines;
  std::string head;  // SHA-256 of the last line; 64 zeros of an empty ledger

  // The last revisions of the edits that were not retired, in the order in which they were added.
  std::vector<survey::MapEdit> Active() const;

  // The others, in the order in which they were retired.
  std::vector<RetiredEdit> Retired() const;
};

// The head of an empty ledger.
std::string EmptyLedgerHead();

// An empty ledger when there is no such file. DataError names file, line, member, value and rule: a broken chain, an
// unknown operation or member, a uid that is added twice, a revision that does not follow the one before.
Ledger ReadLedger(const std::filesystem::path& file);

// Appends the lines in one step (locked, synced, all or none) and returns the new head. Empty, and nothing is written,
// when `expected_head` is given and the ledger has moved on since: somebody else was faster. Fills in what may be
// missing: the uid of an addition (from the chain), the revision. DataError as of ReadLedger for lines that would break
// its rules, who or when that are missing among them.
std::optional<std::string> AppendToLedger(const std::filesystem::path& file, std::vector<LedgerLine> lines,
                                          const std::optional<std::string>& expected_head = std::nullopt);

}  // namespace formats
