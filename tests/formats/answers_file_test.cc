// SPDX-License-Identifier: Apache-2.0
#include "formats/answers_file.h"

#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::ScratchFolder;

const std::vector<survey::StampNs> kStamps = {1000, 2000, 3000, 4000};

survey::Answers Read(const std::vector<std::string>& texts) {
  const ScratchFolder scratch;
  std::vector<std::filesystem::path> files;
  for (const std::string& text : texts) {
    files.push_back(scratch / ("q" + std::to_string(files.size() + 1) + ".json"));
    WriteFileAtomically(files.back(), text);
  }
  return ReadAnswers(files, kStamps);
}

std::string MessageOf(const std::vector<std::string>& texts) {
  try {
    Read(texts);
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

std::string Correct(const std::string& stamp, const std::string& more = "") {
  return R"({"schema": 1, "stamp_ns": )" + stamp + R"(, "decision": "correct", "ref": {"stamp_ns": 1000})" +
         R"(, "pose": [1.5, -0.25, 0.1])" + more + "}";
}

TEST(ReadAnswers, TakesThemInOrderOfTheirScans) {
  const survey::Answers answers =
      Read({Correct("4000", R"(, "sigma": [0.05, 0.06, 0.01])"),
            R"({"schema": 1, "stamp_ns": 2000, "decision": "reject_stretch", "end_ns": 3000, "comment": "lift"})"});
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[0].decision, survey::Decision::kRejectStretch);
  EXPECT_EQ(answers[0].end.value, 2);
  EXPECT_EQ(answers[1].scan.value, 3);
  EXPECT_EQ(answers[1].reference.value, 0);
  EXPECT_EQ(answers[1].reference_from_scan.y, -0.25);
  EXPECT_EQ(answers[1].sigma.y(), 0.06);
}

TEST(ReadAnswers, OrderOfFilesAndRemarksDoNotChangeTheMeaning) {
  const std::string skip = R"({"schema": 1, "stamp_ns": 2000, "decision": "skip"})";
  const std::string one = CanonicalText(Read({Correct("4000"), skip}));
  EXPECT_EQ(one, CanonicalText(Read({skip, Correct("4000", R"(, "operator": "AB", "comment": "by the stairs")")})));
  EXPECT_NE(one, CanonicalText(Read({skip, Correct("4000", R"(, "sigma": [0.1, 0.1, 0.07])")})));
}

TEST(ReadAnswers, RefusesWhatCannotBe) {
  const auto has = [](const std::string& message, const std::string& part) {
    return message.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(MessageOf({Correct("4001")}), "q1.json: stamp_ns = 4001: the block has no scan with this stamp"));
  EXPECT_TRUE(has(MessageOf({Correct("3000"), Correct("3000")}), "q1.json and q2.json: both answer for the scan"));
  EXPECT_TRUE(
      has(MessageOf({Correct("3000", R"(, "sigma": [0.1, 0, 0.08])")}), "sigma = [0.1,0,0.08]: must be positive"));
  EXPECT_TRUE(has(MessageOf({Correct("1000")}), "must be an earlier scan"));
  EXPECT_TRUE(has(MessageOf({Correct("3000", R"(, "sgima": [1, 1, 1])")}), "unknown key \"sgima\""));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "perhaps"})"}), "decision = \"perhaps\""));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "confirm"})"}), "ref is missing"));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "correct", "ref": {"stamp_ns": 1000},
                                 "pose": [500, 0, 0]})"}),
                  "outside the map"));
  EXPECT_TRUE(has(MessageOf({"{"}), "is not JSON"));
}

}  // namespace
}  // namespace formats
