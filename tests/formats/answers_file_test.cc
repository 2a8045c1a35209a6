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

TEST(ReadAnswers, StampsMayBeTexts) {
  EXPECT_EQ(CanonicalText(Read({Correct(R"("4000")")})), CanonicalText(Read({Correct("4000")})));
}

TEST(ReadAnswers, APoseMayBeInTheSite) {
  const survey::Answers answers = Read({R"({"schema": 1, "stamp_ns": 3000, "decision": "correct", "frame": "site",
                                            "pose": [500100.25, 5600200.5, 7.0]})"});
  ASSERT_TRUE(answers[0].site_from_scan);
  EXPECT_EQ(answers[0].site_from_scan->y, 5600200.5);
  EXPECT_NEAR(answers[0].site_from_scan->theta, 7.0 - 2.0 * 3.14159265358979, 1e-12);
  EXPECT_FALSE(answers[0].HasRelativePose());
  EXPECT_FALSE(answers[0].ActsInFilter());
}

std::string Relate(const std::string& relation, const std::string& more = "") {
  return R"({"schema": 1, "stamp_ns": 3000, "decision": "relate", "relation": ")" + relation +
         R"(", "wall": [[1, 2], [4, 2]], "ref": {"stamp_ns": 1000, "wall": [[0, -1], [0, 3]]})" + more + "}";
}

TEST(ReadAnswers, TwoWallsMayBeRelated) {
  const survey::Answers answers = Read({Relate("perpendicular", R"(, "sigma": [0.1, 0.01])")});
  ASSERT_TRUE(answers[0].walls);
  EXPECT_EQ(answers[0].walls->relation, survey::WallRelation::kPerpendicular);
  EXPECT_EQ(answers[0].walls->in_target.b.x(), 4.0);
  EXPECT_EQ(answers[0].walls->in_base.b.y(), 3.0);
  EXPECT_EQ(answers[0].wall_sigma.y(), 0.01);
  EXPECT_TRUE(answers[0].ActsInFilter());
  EXPECT_NE(CanonicalText(answers), CanonicalText(Read({Relate("parallel", R"(, "sigma": [0.1, 0.01])")})));
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
  EXPECT_TRUE(has(MessageOf({Correct("3000", R"(, "sigma": [1e999, 1, 1])")}), "q1.json: is not JSON"));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "perhaps"})"}), "decision = \"perhaps\""));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "confirm"})"}), "ref is missing"));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "correct", "ref": {"stamp_ns": 1000},
                                 "pose": [500, 0, 0]})"}),
                  "outside the map"));
  EXPECT_TRUE(
      has(MessageOf({Correct("3000", R"(, "frame": "site")")}), "a pose in the frame \"site\" has no reference"));
  EXPECT_TRUE(has(MessageOf({Correct("3000", R"(, "frame": "map")")}), "frame = \"map\": must be ref or site"));
  EXPECT_TRUE(has(MessageOf({Correct(R"("3000x")")}), "expected the stamp of a scan in nanoseconds"));
  EXPECT_TRUE(has(MessageOf({Relate("askew")}), "relation = \"askew\": must be collinear, parallel or perpendicular"));
  EXPECT_TRUE(has(MessageOf({Relate("parallel", R"(, "sigma": [0.1, -1])")}), "sigma = [0.1,-1]: must be positive"));
  EXPECT_TRUE(has(MessageOf({R"({"schema": 1, "stamp_ns": 3000, "decision": "relate", "relation": "parallel",
                                 "wall": [[1, 2], [1.2, 2]], "ref": {"stamp_ns": 1000, "wall": [[0, 0], [1, 0]]}})"}),
                  "wall = [[1,2],[1.2,2]]: is shorter than 0.5 m"));
  EXPECT_TRUE(has(MessageOf({"{"}), "is not JSON"));
}

}  // namespace
}  // namespace formats
