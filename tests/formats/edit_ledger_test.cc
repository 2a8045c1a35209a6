// SPDX-License-Identifier: Apache-2.0
#include "formats/edit_ledger.h"

#include <gtest/gtest.h>

#include <thread>

#include "formats/atomic_file.h"
#include "formats/digest.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using survey::EditKind;
using survey::MapEdit;

MapEdit Wall(const std::string& uid = "") {
  MapEdit edit{.uid = uid, .kind = EditKind::kLineOccupied, .parts = {{{500000.1, 5600000.25}, {500003, 5600004}}}};
  edit.width_m = 0.2;
  edit.obstacle = survey::ObstacleClass::kGlass;
  edit.who = "M. Huber";
  edit.when = "2026-11-28T10:15:00Z";
  edit.why = "glass \"front\"";
  edit.basis = {{"A", "60de"}};
  edit.anchors = {{"A", {survey::EditAnchor{1007204000000, {2.1043, -0.331}}, std::nullopt}}};
  return edit;
}

MapEdit Retired(const std::string& uid) {
  MapEdit edit{.uid = uid};
  edit.who = "AB";
  edit.when = "2026-11-29T08:00:00Z";
  return edit;
}

class LedgerTest : public testing::Test {
 protected:
  // The message of the DataError that reading gives; empty when it succeeds.
  std::string Refusal() const {
    try {
      ReadLedger(file_);
      return "";
    } catch (const DataError& error) {
      return error.what();
    }
  }
  std::string RefusalOfAppending(const LedgerLine& line) const {
    try {
      AppendToLedger(file_, {line});
      return "";
    } catch (const DataError& error) {
      return error.what();
    }
  }

  test_support::ScratchFolder scratch_;
  std::filesystem::path file_ = scratch_ / "edits/ledger.jsonl";
};

TEST_F(LedgerTest, WhatWasAppendedIsReadBack) {
  EXPECT_EQ(ReadLedger(file_).head, EmptyLedgerHead());
  MapEdit mask{.uid = "m1", .kind = EditKind::kMaskReturns, .parts = {{{0, 0}, {4, 0}, {4, 4}}}};
  mask.who = "AB";
  mask.when = "2026-11-28T10:16:00Z";
  mask.beams = {{"B", {{12, 3, 5}, {14, 0, 0}}}};
  mask.supersedes = {"w1"};
  const auto head = AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("w1")}, {LedgerOperation::kAdd, mask}});
  const Ledger ledger = ReadLedger(file_);
  EXPECT_EQ(ledger.head, head);
  ASSERT_EQ(ledger.Active().size(), 2U);
  EXPECT_EQ(ledger.Active()[0], Wall("w1"));
  EXPECT_EQ(ledger.Active()[1], mask);
}

TEST_F(LedgerTest, ModifiedAndRetiredEdits) {
  AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("a")}, {LedgerOperation::kAdd, Wall("b")}});
  MapEdit longer = Wall("a");
  longer.parts.front().back() = {500009, 5600004};
  AppendToLedger(file_, {{LedgerOperation::kModify, longer}, {LedgerOperation::kRetire, Retired("b")}});
  const std::vector<MapEdit> active = ReadLedger(file_).Active();
  ASSERT_EQ(active.size(), 1U);
  EXPECT_EQ(active[0].revision, 2);
  EXPECT_EQ(active[0].parts, longer.parts);
  EXPECT_EQ(ReadLedger(file_).lines.size(), 4U) << "nothing is taken away";
  const std::vector<RetiredEdit> retired = ReadLedger(file_).Retired();
  ASSERT_EQ(retired.size(), 1U);
  EXPECT_EQ(retired[0].edit, Wall("b"));
  EXPECT_EQ(retired[0].retirement.who, "AB");
}

TEST_F(LedgerTest, AnAdditionGetsAUidOfItsOwn) {
  AppendToLedger(file_, {{LedgerOperation::kAdd, Wall()}, {LedgerOperation::kAdd, Wall()}});
  const std::vector<MapEdit> active = ReadLedger(file_).Active();
  ASSERT_EQ(active.size(), 2U);
  EXPECT_EQ(active[0].uid.size(), 12U);
  EXPECT_NE(active[0].uid, active[1].uid);
}

TEST_F(LedgerTest, ABrokenChainIsNamedWithItsLine) {
  AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("a")}});
  AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("b")}});
  AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("c")}});
  const std::string whole = ReadWholeFile(file_);
  const std::size_t second = whole.find('\n') + 1;
  const std::size_t third = whole.find('\n', second) + 1;
  std::string changed = whole;
  changed.replace(changed.find("M. Huber"), 8, "M. Hubez");
  const struct {
    std::string text;
    std::string expected;
  } cases[] = {
      {changed, "ledger.jsonl:2: prev = "},
      {whole.substr(0, second) + whole.substr(third), "ledger.jsonl:2: prev = "},
      {whole.substr(second), "ledger.jsonl:1: prev = "},
      {whole.substr(0, whole.size() - 1), "cut off"},
      {whole.substr(0, whole.size() - 5) + "\n", "ledger.jsonl:3: is not JSON"},
      {whole + "{}\n", "ledger.jsonl:4: prev = null"},
  };
  for (const auto& one : cases) {
    WriteFileAtomically(file_, one.text);
    EXPECT_NE(Refusal().find(one.expected), std::string::npos) << Refusal();
    EXPECT_NE(RefusalOfAppending({LedgerOperation::kAdd, Wall("d")}), "") << "nothing is put on top";
    EXPECT_EQ(ReadWholeFile(file_), one.text);
  }
}

TEST_F(LedgerTest, LinesThatBreakTheRulesAreRefused) {
  AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("a")}});
  const std::string before = ReadWholeFile(file_);
  MapEdit nobody = Wall("b");
  nobody.who = "";
  MapEdit some_day = Wall("b");
  some_day.when = "yesterday";
  MapEdit late = Wall("a");
  late.revision = 5;
  const std::pair<LedgerLine, std::string> cases[] = {
      {{LedgerOperation::kAdd, Wall("a")}, "uid = \"a\": is in the ledger already"},
      {{LedgerOperation::kAdd, Wall("a b")}, "must be 1 to 64 letters"},
      {{LedgerOperation::kAdd, nobody}, "who is missing"},
      {{LedgerOperation::kAdd, some_day}, "when = \"yesterday\": must be a time in UTC"},
      {{LedgerOperation::kModify, Wall("b")}, "uid = \"b\": there is no such edit"},
      {{LedgerOperation::kModify, late}, "rev = 5: edit a is at revision 1"},
      {{LedgerOperation::kRetire, Retired("b")}, "uid = \"b\": there is no such edit"},
  };
  for (const auto& [line, expected] : cases)
    EXPECT_NE(RefusalOfAppending(line).find(expected), std::string::npos) << RefusalOfAppending(line);
  EXPECT_EQ(ReadWholeFile(file_), before);
}

TEST_F(LedgerTest, WhoeverLookedAtAnOlderStateIsToldAndNothingIsWritten) {
  const std::string head = AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("a")}}).value();
  ASSERT_TRUE(AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("b")}}, head));
  const std::string before = ReadWholeFile(file_);
  EXPECT_FALSE(AppendToLedger(file_, {{LedgerOperation::kAdd, Wall("c")}}, head));
  EXPECT_EQ(ReadWholeFile(file_), before);
}

TEST_F(LedgerTest, TwoAtOnceLoseNothing) {
  const auto append = [&](const std::string& prefix) {
    for (int i = 0; i < 20; ++i) AppendToLedger(file_, {{LedgerOperation::kAdd, Wall(prefix + std::to_string(i))}});
  };
  std::thread one(append, "a");
  std::thread other(append, "b");
  one.join();
  other.join();
  EXPECT_EQ(ReadLedger(file_).Active().size(), 40U);
}

}  // namespace
}  // namespace formats
