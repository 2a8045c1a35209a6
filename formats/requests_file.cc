// SPDX-License-Identifier: Apache-2.0
#include "formats/requests_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/edit_json.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "plumbline-requests";
constexpr int kVersion = 2;

double Millimetres(double value) { return std::round(value * 1e3) / 1e3 + 0.0; }
double Fine(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

json ToJson(const survey::Pose2& pose) {
  return {{"x", Millimetres(pose.x)}, {"y", Millimetres(pose.y)}, {"theta", Fine(pose.theta)}};
}

json ToJson(const std::vector<Eigen::Vector2f>& points) {
  json list = json::array();
  for (const Eigen::Vector2f& p : points)
    list.push_back({Millimetres(static_cast<double>(p.x())), Millimetres(static_cast<double>(p.y()))});
  return list;
}

json ToJson(const survey::PoseMode& mode) {
  json object = ToJson(mode.site_from_scan);
  object["cause"] = mode.cause;
  object["weight"] = Fine(mode.weight);
  return object;
}

json ToJson(const ListedReference& reference) {
  json object = ToJson(reference.site_from_scan);
  object["stamp_ns"] = std::to_string(reference.stamp_ns);
  object["kind"] = reference.earlier_pass ? "earlier pass" : "before";
  return object;
}

json ToJson(const survey::PoseSpread& spread) {
  return {{"along", Fine(spread.along)}, {"across", Fine(spread.across)}, {"heading", Fine(spread.heading)}};
}

json ToJson(const ListedAnswer& answer) {
  return {{"file", answer.file},
          {"decision", std::string(Name(answer.decision))},
          {"stamp_ns", std::to_string(answer.stamp_ns)}};
}

template <typename T>
json OrNull(const std::optional<T>& value) {
  return value ? ToJson(*value) : json();
}

json MembersOf(const ListedPose& pose) {
  json modes = json::array();
  for (const survey::PoseMode& mode : pose.modes) modes.push_back(ToJson(mode));
  return {{"kind", "pose"},
          {"stamp_ns", std::to_string(pose.stamp_ns)},
          {"from_ns", std::to_string(pose.from_ns)},
          {"until_ns", std::to_string(pose.until_ns)},
          {"estimate", ToJson(pose.estimate)},
          {"spread", OrNull(pose.spread)},
          {"modes", std::move(modes)},
          {"reference", OrNull(pose.reference)},
          {"points", ToJson(pose.points)},
          {"reference_points", ToJson(pose.reference_points)},
          {"answer", OrNull(pose.answer)}};
}

json MembersOf(const survey::AppliedEdit& applied) {
  return {{"kind", "edit"},
          {"edit", formats::ToJson(applied.edit)},
          {"drawn", applied.drawn.empty() ? json() : GeometryToJson(AsDrawn(applied))}};
}

json ToJson(const ListedRequest& request, int rank) {
  json causes = json::array();
  for (const survey::RequestCause& cause : request.causes)
    causes.push_back({{"cause", cause.cause}, {"score", Fine(cause.size_m)}, {"message", cause.message}});
  json object = std::visit([](const auto& subject) { return MembersOf(subject); }, request.subject);
  object.update({{"id", request.id},
                 {"block", request.block},
                 {"rank", rank},
                 {"causes", std::move(causes)},
                 {"score", Fine(request.score_m)},
                 {"picture", request.picture}});
  return object;
}

json ToJson(const ListedBlock& block) {
  const survey::BlockReview& review = block.review;
  return {{"name", block.name},
          {"tied", block.tied},
          {"crs", block.crs},
          {"map", block.map},
          {"requests", review.num_requests},
          {"answered", review.num_answered},
          {"skipped", review.num_skipped},
          {"open", review.num_open},
          {"answers", review.num_answers},
          {"contradiction", {{"compared", review.cells_compared}, {"contradicted", review.cells_contradicted}}}};
}

ListedBlock BlockFromJson(const json& object) {
  const json& contradiction = object.at("contradiction");
  return {.name = object.at("name").get<std::string>(),
          .tied = object.at("tied").get<bool>(),
          .crs = object.at("crs").get<std::string>(),
          .map = object.at("map").get<std::string>(),
          .review = {.num_requests = object.at("requests").get<int>(),
                     .num_answered = object.at("answered").get<int>(),
                     .num_skipped = object.at("skipped").get<int>(),
                     .num_open = object.at("open").get<int>(),
                     .num_answers = object.at("answers").get<int>(),
                     .cells_compared = contradiction.at("compared").get<int>(),
                     .cells_contradicted = contradiction.at("contradicted").get<int>()}};
}

}  // namespace

std::string IdOfRequest(const std::string& block, const std::string& what, const std::string& cause) {
  return block + "-" + what + "-" + cause;
}

void Rank(std::vector<ListedRequest>* requests) {
  std::sort(requests->begin(), requests->end(), [](const ListedRequest& a, const ListedRequest& b) {
    if (a.IsAnswered() != b.IsAnswered()) return b.IsAnswered();
    if (a.score_m != b.score_m) return a.score_m > b.score_m;
    return a.id < b.id;
  });
}

void WriteRequests(const std::filesystem::path& file, const RequestList& list, const Provenance& provenance) {
  json blocks = json::array();
  for (const ListedBlock& block : list.blocks) blocks.push_back(ToJson(block));
  const json head = {{"format", kFormat},
                     {"format_version", kVersion},
                     {"num_requests", list.requests.size()},
                     {"blocks", std::move(blocks)},
                     {"provenance", ToJson(provenance)}};
  std::string text = JsonText(head) + "\n";
  int rank = 0;
  for (const ListedRequest& request : list.requests) text += JsonText(ToJson(request, ++rank)) + "\n";
  WriteFileAtomically(file, text);
}

std::vector<ListedBlock> ReadReviewedBlocks(const std::filesystem::path& file) {
  const std::string text = ReadWholeFile(file);
  const json head = JsonOrDiscarded(text.substr(0, text.find('\n')));
  if (!head.is_object() || head.value("format", "") != kFormat || head.value("format_version", 0) != kVersion)
    throw DataError(file.string() + ": is not a list of requests of this version (or was cut off)");
  try {
    const auto lines = std::count(text.begin(), text.end(), '\n');
    if (lines != head.at("num_requests").get<std::ptrdiff_t>() + 1)
      throw DataError(file.string() + ": was cut off: " + std::to_string(lines - 1) + " of " +
                      JsonText(head.at("num_requests")) + " requests");
    std::vector<ListedBlock> blocks;
    for (const json& block : head.at("blocks")) blocks.push_back(BlockFromJson(block));
    return blocks;
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

}  // namespace formats
