// SPDX-License-Identifier: Apache-2.0
#include "formats/filter_checkpoint.h"

#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using survey::Answer;
using survey::Decision;

Answer Correct(int scan, int reference) {
  return {.name = "a.json", .scan = {scan}, .decision = Decision::kCorrect, .reference = {reference}};
}

FilterCheckpoint Checkpoint(const survey::Answers& answers) {
  FilterCheckpoint checkpoint{.key = "key", .answers = AnswersInFilter(answers)};
  for (int scan = 0; scan < 100; scan += 10) {
    checkpoint.tree.push_back({.scan = {scan},
                               .poses = {{0.1 * scan, 1.0, -0.5}, {2.0, 3.0, 0.25}},
                               .parents = {0, 0},
                               .log_weights = {-0.1, -2.3},
                               .evidence = {5.0, 6.0},
                               .effective_size = 1.5,
                               .resampled = scan % 20 == 0});
  }
  return checkpoint;
}

TEST(FilterCheckpoint, ComesBackAsItWasWritten) {
  const test_support::ScratchFolder scratch;
  const FilterCheckpoint written = Checkpoint({Correct(70, 30)});
  WriteCheckpoint(scratch / "c", written);
  const std::optional<FilterCheckpoint> read = ReadCheckpoint(scratch / "c");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->key, "key");
  EXPECT_EQ(read->answers, written.answers);
  ASSERT_EQ(read->tree.size(), written.tree.size());
  EXPECT_EQ(read->tree[3].poses[0].Vector(), written.tree[3].poses[0].Vector());
  EXPECT_EQ(read->tree[3].log_weights, written.tree[3].log_weights);
  EXPECT_EQ(read->tree[4].resampled, true);
}

TEST(FilterCheckpoint, DamagedOrMissingIsNone) {
  const test_support::ScratchFolder scratch;
  EXPECT_FALSE(ReadCheckpoint(scratch / "c"));
  EXPECT_FALSE(ReadCheckpoint(""));
  WriteCheckpoint(scratch / "c", Checkpoint({}));
  std::string bytes = ReadWholeFile(scratch / "c");
  bytes[bytes.size() / 2] ^= 1;
  WriteFileAtomically(scratch / "c", bytes);
  EXPECT_FALSE(ReadCheckpoint(scratch / "c"));
  WriteFileAtomically(scratch / "c", bytes.substr(0, 30));
  EXPECT_FALSE(ReadCheckpoint(scratch / "c"));
}

std::size_t Hold(const survey::Answers& before, const survey::Answers& after) {
  return UpdatesThatHold(Checkpoint(before), AnswersInFilter(after)).size();
}

TEST(FilterCheckpoint, UpdatesHoldUpToTheFirstScanThatAChangedAnswerTouches) {
  const survey::Answers before = {Correct(50, 20), Correct(80, 60)};
  EXPECT_EQ(Hold(before, before), 10U);
  EXPECT_EQ(Hold(before, {before[0]}), 6U);  // before scan 60, the reference of the one that is gone
  survey::Answers after = before;
  after[0].sigma.x() = 0.05;
  EXPECT_EQ(Hold(before, after), 2U);
  EXPECT_EQ(Hold(before, {before[0], before[1], {.scan = {85}, .decision = Decision::kRejectStretch, .end = {95}}}),
            9U);
}

TEST(FilterCheckpoint, TheFirstScanIsAnUpdateWhateverIsAnswered) {
  EXPECT_EQ(Hold({}, {{.scan = {40}, .decision = Decision::kConfirm, .reference = {0}}}), 4U);
  EXPECT_EQ(Hold({}, {{.scan = {40}, .decision = Decision::kConfirm, .reference = {20}}}), 2U);
}

TEST(FilterCheckpoint, AnswersThatTheFilterDoesNotUseChangeNothing) {
  Answer in_site = Correct(30, -1);
  in_site.site_from_scan = survey::Pose2{1.0, 2.0, 3.0};
  EXPECT_EQ(Hold({}, {in_site, {.scan = {60}, .decision = Decision::kSkip}}), 10U);
}

}  // namespace
}  // namespace formats
