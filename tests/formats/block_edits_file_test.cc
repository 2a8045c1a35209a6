// SPDX-License-Identifier: Apache-2.0
#include "formats/block_edits_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/edit_json.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

// Scans that moved apart have crossed the sides of a square: an artefact like any other, though nobody may draw it.
TEST(BlockEditsFile, HoldsEditsThatTheirScansHaveTornApart) {
  const test_support::ScratchFolder scratch;
  survey::AppliedEdit torn{.edit = {.uid = "yard", .kind = survey::EditKind::kAreaFree}};
  torn.drawn = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};
  torn.edit.parts = {{{0, 0}, {4, 4}, {4, 0}, {0, 4}}};
  torn.residual_m = 1.5;
  const survey::EditFinding bent{survey::FindingKind::kEditReview, {"yard"}, "bent", 1.5};
  WriteBlockEdits(scratch / "edits.json", {.block = "A", .edits = {torn}, .findings = {bent}},
                  {.records = {{.stage = "edit", .version = "1"}}});
  const survey::BlockEdits read = ReadBlockEdits(scratch / "edits.json");
  ASSERT_EQ(read.edits.size(), 1U);
  EXPECT_EQ(read.edits[0].edit.parts, torn.edit.parts);
  EXPECT_EQ(read.edits[0].drawn, torn.drawn);
  EXPECT_EQ(read.edits[0].residual_m, 1.5);
  ASSERT_EQ(read.findings.size(), 1U);
  EXPECT_EQ(read.findings[0].size_m, 1.5);
  EXPECT_THROW(EditFromJson(ToJson(torn.edit), "ledger"), DataError);
}

}  // namespace
}  // namespace formats
