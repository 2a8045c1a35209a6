// SPDX-License-Identifier: Apache-2.0
#include "formats/answers_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::Answer;
using survey::Decision;

constexpr std::array kDecisions = {Decision::kConfirm, Decision::kCorrect,       Decision::kPick,
                                   Decision::kRelate,  Decision::kRejectStretch, Decision::kSkip};
constexpr std::array kRelations = {survey::WallRelation::kCollinear, survey::WallRelation::kParallel,
                                   survey::WallRelation::kPerpendicular};
constexpr std::array kKnownKeys = {"schema", "stamp_ns", "decision", "frame",    "ref",
                                   "pose",   "sigma",    "end_ns",   "relation", "wall"};
// For people: they do not count.
constexpr std::array kRemarks = {"id", "operator", "tool", "shown_at", "answered_at", "comment"};
constexpr double kMaxDistance_m = 100.0;
constexpr double kShortestWall_m = 0.5;

// Reads one answer; every complaint starts with its file.
class AnswerReader {
 public:
  AnswerReader(const std::filesystem::path& file, const std::vector<survey::StampNs>& stamps)
      : file_(file), stamps_(stamps) {}

  Answer Read() {
    try {
      document_ = ParsedJson(ReadWholeFile(file_));
    } catch (const json::exception& error) {
      Fail(std::string("is not JSON: ") + error.what());
    }
    if (!document_.is_object()) Fail("expected an object");
    CheckKeys();
    Answer answer{.name = file_.filename().string()};
    answer.scan = ScanAt("stamp_ns", Get("stamp_ns"));
    answer.decision = ReadDecision();
    if (answer.HasPose()) ReadPose(&answer);
    if (answer.decision == Decision::kRelate) ReadWalls(&answer);
    if (answer.decision == Decision::kRejectStretch) {
      answer.end = ScanAt("end_ns", Get("end_ns"));
      if (answer.end < answer.scan) FailAt("end_ns", Get("end_ns"), "must not be before stamp_ns");
    }
    return answer;
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { throw DataError(file_.string() + ": " + rule); }
  [[noreturn]] void FailAt(const std::string& key, const json& value, const std::string& rule) const {
    Fail(key + " = " + JsonText(value).substr(0, 80) + ": " + rule);
  }

  const json& Get(const char* key) const {
    if (!document_.contains(key)) Fail(std::string(key) + " is missing");
    return document_[key];
  }

  void CheckKeys() const {
    const auto among = [](const auto& names, const std::string& key) {
      return std::find(names.begin(), names.end(), key) != names.end();
    };
    for (const auto& [key, value] : document_.items()) {
      if (among(kRemarks, key)) continue;
      if (!among(kKnownKeys, key))
        Fail("unknown key \"" + key + "\"; known are schema, stamp_ns, decision, frame, ref, pose, sigma, end_ns, " +
             "relation, wall, and the remarks id, operator, tool, shown_at, answered_at, comment");
    }
    if (Get("schema") != 1) FailAt("schema", Get("schema"), "must be 1");
  }

  Decision ReadDecision() const {
    for (const Decision decision : kDecisions) {
      if (Get("decision") == Name(decision)) return decision;
    }
    FailAt("decision", Get("decision"), "must be confirm, correct, pick, relate, reject_stretch or skip");
  }

  // A number or, as pages in a browser need it, a text.
  static std::optional<survey::StampNs> StampOf(const json& value) {
    if (value.is_number_integer()) return value.get<survey::StampNs>();
    if (!value.is_string()) return std::nullopt;
    const std::string& text = value.get_ref<const std::string&>();
    survey::StampNs stamp = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), stamp);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(stamp) : std::nullopt;
  }

  survey::ScanId ScanAt(const char* key, const json& value) const {
    const std::optional<survey::StampNs> stamp = StampOf(value);
    if (!stamp) FailAt(key, value, "expected the stamp of a scan in nanoseconds");
    const auto found = std::lower_bound(stamps_.begin(), stamps_.end(), *stamp);
    if (found == stamps_.end() || *found != *stamp) FailAt(key, value, "the block has no scan with this stamp");
    return {static_cast<int>(found - stamps_.begin())};
  }

  bool InSite() const {
    if (!document_.contains("frame") || document_["frame"] == "ref") return false;
    if (document_["frame"] != "site") FailAt("frame", document_["frame"], "must be ref or site");
    if (document_.contains("ref")) FailAt("ref", document_["ref"], "a pose in the frame \"site\" has no reference");
    return true;
  }

  void ReadReference(const char* form, std::size_t keys, Answer* answer) const {
    const json& reference = Get("ref");
    if (!reference.is_object() || !reference.contains("stamp_ns") || reference.size() != keys)
      FailAt("ref", reference, form);
    answer->reference = ScanAt("ref.stamp_ns", reference["stamp_ns"]);
    if (!(answer->reference < answer->scan)) FailAt("ref", reference, "must be an earlier scan");
  }

  void ReadPose(Answer* answer) const {
    const bool in_site = InSite();
    if (!in_site) ReadReference("expected {\"stamp_ns\": the scan in whose frame the pose is given}", 1, answer);
    const auto numbers = Numbers<3>("pose", Get("pose"), "expected [x (m), y (m), theta (rad)]");
    const survey::Pose2 pose{numbers.x(), numbers.y(), survey::NormalizeAngle(numbers.z())};
    if (in_site) {
      answer->site_from_scan = pose;
    } else {
      if (pose.Translation().norm() > kMaxDistance_m)
        FailAt("pose", document_["pose"], "outside the map: farther than 100 m from the reference");
      answer->reference_from_scan = pose;
    }
    if (answer->decision == Decision::kConfirm) answer->sigma = {0.2, 0.2, 0.07};
    ReadSigma("expected [x (m), y (m), theta (rad)]", &answer->sigma);
  }

  void ReadWalls(Answer* answer) const {
    ReadReference("expected {\"stamp_ns\": an earlier scan, \"wall\": a wall in its frame}", 2, answer);
    survey::WallPair& walls = answer->walls.emplace();
    const auto relation = std::find_if(kRelations.begin(), kRelations.end(),
                                       [&](survey::WallRelation each) { return Get("relation") == Name(each); });
    if (relation == kRelations.end())
      FailAt("relation", Get("relation"), "must be collinear, parallel or perpendicular");
    walls.relation = *relation;
    if (!document_["ref"].contains("wall")) Fail("ref.wall is missing");
    walls.in_base = ReadWall("ref.wall", document_["ref"]["wall"]);
    walls.in_target = ReadWall("wall", Get("wall"));
    ReadSigma("expected [distance (m), angle (rad)]", &answer->wall_sigma);
  }

  survey::WallSegment ReadWall(const char* key, const json& value) const {
    constexpr const char* kForm = "expected [[x, y], [x, y]], the ends of a wall (m)";
    if (!value.is_array() || value.size() != 2) FailAt(key, value, kForm);
    const survey::WallSegment wall{Numbers<2>(key, value[0], kForm), Numbers<2>(key, value[1], kForm)};
    if (wall.Length() < kShortestWall_m) FailAt(key, value, "is shorter than 0.5 m: its direction is too vague");
    if (std::max(wall.a.norm(), wall.b.norm()) > kMaxDistance_m) FailAt(key, value, "farther than 100 m from its scan");
    return wall;
  }

  template <int N>
  void ReadSigma(const char* form, Eigen::Vector<double, N>* sigma) const {
    if (!document_.contains("sigma")) return;
    *sigma = Numbers<N>("sigma", document_["sigma"], form);
    if (!(sigma->minCoeff() > 0.0)) FailAt("sigma", document_["sigma"], "must be positive");
  }

  template <int N>
  Eigen::Vector<double, N> Numbers(const char* key, const json& value, const char* form) const {
    const bool fits = value.is_array() && value.size() == N &&
                      std::all_of(value.begin(), value.end(), [](const json& number) { return number.is_number(); });
    if (!fits) FailAt(key, value, form);
    Eigen::Vector<double, N> numbers;
    for (int i = 0; i < N; ++i) numbers[i] = value[static_cast<std::size_t>(i)].get<double>();
    if (!numbers.allFinite()) FailAt(key, value, "must be finite");
    return numbers;
  }

  const std::filesystem::path& file_;
  const std::vector<survey::StampNs>& stamps_;
  json document_;
};

}  // namespace

survey::Answers ReadAnswers(const std::vector<std::filesystem::path>& files,
                            const std::vector<survey::StampNs>& stamps) {
  survey::Answers answers;
  for (const std::filesystem::path& file : files) answers.push_back(AnswerReader(file, stamps).Read());
  std::sort(answers.begin(), answers.end(),
            [](const Answer& a, const Answer& b) { return a.scan != b.scan ? a.scan < b.scan : a.name < b.name; });
  for (std::size_t i = 1; i < answers.size(); ++i) {
    if (answers[i].scan == answers[i - 1].scan)
      throw DataError(answers[i - 1].name + " and " + answers[i].name + ": both answer for the scan with stamp_ns = " +
                      std::to_string(stamps[static_cast<std::size_t>(answers[i].scan.value)]) + "; keep one");
  }
  return answers;
}

std::string CanonicalLine(const Answer& answer) {
  std::string line = std::to_string(answer.scan.value) + " " + std::string(Name(answer.decision));
  const auto add = [&line](std::initializer_list<double> numbers) {
    for (const double number : numbers) {
      char text[40];
      std::snprintf(text, sizeof text, " %.17g", number);
      line += text;
    }
  };
  const auto add_wall = [&](const survey::WallSegment& wall) { add({wall.a.x(), wall.a.y(), wall.b.x(), wall.b.y()}); };
  if (answer.reference.value >= 0) line += " ref " + std::to_string(answer.reference.value);
  if (answer.end.value >= 0) line += " end " + std::to_string(answer.end.value);
  if (answer.HasPose()) {
    const survey::Pose2 pose = answer.site_from_scan.value_or(answer.reference_from_scan);
    line += answer.site_from_scan ? " site" : "";
    add({pose.x, pose.y, pose.theta, answer.sigma.x(), answer.sigma.y(), answer.sigma.z()});
  }
  if (answer.walls) {
    line += " " + std::string(Name(answer.walls->relation));
    add_wall(answer.walls->in_base);
    add_wall(answer.walls->in_target);
    add({answer.wall_sigma.x(), answer.wall_sigma.y()});
  }
  return line;
}

std::string CanonicalText(const survey::Answers& answers) {
  std::string text;
  for (const Answer& answer : answers) text += CanonicalLine(answer) + "\n";
  return text;
}

}  // namespace formats
