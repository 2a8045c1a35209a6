// SPDX-License-Identifier: Apache-2.0
#include "formats/answers_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::Answer;
using survey::Decision;

constexpr std::array kDecisions = {Decision::kConfirm, Decision::kCorrect, Decision::kPick, Decision::kRejectStretch,
                                   Decision::kSkip};
constexpr std::array kKnownKeys = {"schema", "stamp_ns", "decision", "ref", "pose", "sigma", "end_ns"};
// For people: they do not count.
constexpr std::array kRemarks = {"id", "operator", "tool", "shown_at", "answered_at", "comment"};
constexpr double kMaxDistance_m = 100.0;

// Reads one answer; every complaint starts with its file.
class AnswerReader {
 public:
  AnswerReader(const std::filesystem::path& file, const std::vector<survey::StampNs>& stamps)
      : file_(file), stamps_(stamps) {}

  Answer Read() {
    try {
      document_ = json::parse(ReadWholeFile(file_));
    } catch (const json::parse_error& error) {
      Fail(std::string("is not JSON: ") + error.what());
    }
    if (!document_.is_object()) Fail("expected an object");
    CheckKeys();
    Answer answer{.name = file_.filename().string()};
    answer.scan = ScanAt("stamp_ns", Get("stamp_ns"));
    answer.decision = ReadDecision();
    if (answer.HasPose()) ReadPose(&answer);
    if (answer.decision == Decision::kRejectStretch) {
      answer.end = ScanAt("end_ns", Get("end_ns"));
      if (answer.end < answer.scan) FailAt("end_ns", Get("end_ns"), "must not be before stamp_ns");
    }
    return answer;
  }

 private:
  [[noreturn]] void Fail(const std::string& rule) const { throw DataError(file_.string() + ": " + rule); }
  [[noreturn]] void FailAt(const std::string& key, const json& value, const std::string& rule) const {
    Fail(key + " = " + value.dump().substr(0, 80) + ": " + rule);
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
        Fail("unknown key \"" + key + "\"; known are schema, stamp_ns, decision, ref, pose, sigma, end_ns, and the " +
             "remarks id, operator, tool, shown_at, answered_at, comment");
    }
    if (Get("schema") != 1) FailAt("schema", Get("schema"), "must be 1");
  }

  Decision ReadDecision() const {
    for (const Decision decision : kDecisions) {
      if (Get("decision") == Name(decision)) return decision;
    }
    FailAt("decision", Get("decision"), "must be confirm, correct, pick, reject_stretch or skip");
  }

  survey::ScanId ScanAt(const char* key, const json& value) const {
    if (!value.is_number_integer()) FailAt(key, value, "expected the stamp of a scan in nanoseconds");
    const auto found = std::lower_bound(stamps_.begin(), stamps_.end(), value.get<survey::StampNs>());
    if (found == stamps_.end() || *found != value.get<survey::StampNs>())
      FailAt(key, value, "the block has no scan with this stamp");
    return {static_cast<int>(found - stamps_.begin())};
  }

  void ReadPose(Answer* answer) const {
    const json& reference = Get("ref");
    if (!reference.is_object() || !reference.contains("stamp_ns") || reference.size() != 1)
      FailAt("ref", reference, "expected {\"stamp_ns\": the scan in whose frame the pose is given}");
    answer->reference = ScanAt("ref.stamp_ns", reference["stamp_ns"]);
    if (!(answer->reference < answer->scan)) FailAt("ref", reference, "must be an earlier scan");
    const Eigen::Vector3d pose = ReadThree("pose");
    if (pose.head<2>().norm() > kMaxDistance_m)
      FailAt("pose", document_["pose"], "outside the map: farther than 100 m from the reference");
    answer->reference_from_scan = {pose.x(), pose.y(), survey::NormalizeAngle(pose.z())};
    if (answer->decision == Decision::kConfirm) answer->sigma = {0.2, 0.2, 0.07};
    if (!document_.contains("sigma")) return;
    answer->sigma = ReadThree("sigma");
    if (!(answer->sigma.minCoeff() > 0.0)) FailAt("sigma", document_["sigma"], "must be positive");
  }

  Eigen::Vector3d ReadThree(const char* key) const {
    const json& value = Get(key);
    const bool three = value.is_array() && value.size() == 3 &&
                       std::all_of(value.begin(), value.end(), [](const json& number) { return number.is_number(); });
    if (!three) FailAt(key, value, "expected [x (m), y (m), theta (rad)]");
    const Eigen::Vector3d numbers(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
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

std::string CanonicalText(const survey::Answers& answers) {
  std::string text;
  for (const Answer& answer : answers) {
    char line[400];
    std::snprintf(line, sizeof line, "%d %s %d %d %.17g %.17g %.17g %.17g %.17g %.17g\n", answer.scan.value,
                  std::string(Name(answer.decision)).c_str(), answer.reference.value, answer.end.value,
                  answer.reference_from_scan.x, answer.reference_from_scan.y, answer.reference_from_scan.theta,
                  answer.sigma.x(), answer.sigma.y(), answer.sigma.z());
    text += line;
  }
  return text;
}

}  // namespace formats
