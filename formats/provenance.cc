// SPDX-License-Identifier: Apache-2.0
#include "formats/provenance.h"

#include <nlohmann/json.hpp>

#include "formats/digest.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {
namespace {

nlohmann::json RecordToJson(const ProvenanceRecord& record) {
  nlohmann::json inputs = nlohmann::json::array();
  for (const ProvenanceInput& input : record.inputs) {
    nlohmann::json one = {{"role", input.role}, {"sha256", input.sha256}};
    if (input.comments_ignored) one["comments_ignored"] = true;
    if (!input.record_id.empty()) one["record"] = input.record_id;
    inputs.push_back(std::move(one));
  }
  return {
      {"stage", record.stage}, {"version", record.version}, {"options", record.options}, {"inputs", std::move(inputs)}};
}

}  // namespace

std::string ProvenanceRecord::Id() const { return Sha256(JsonText(RecordToJson(*this))); }

Provenance WithInputs(const Provenance& whole, std::vector<ProvenanceInput> inputs) {
  std::map<std::string, const ProvenanceRecord*> known;
  for (const ProvenanceRecord& record : whole.records) known.emplace(record.Id(), &record);
  Provenance part{.records = {whole.Own()}};
  part.records.front().inputs = std::move(inputs);
  std::map<std::string, const ProvenanceRecord*> ancestors;
  std::vector<const ProvenanceRecord*> open = {&part.records.front()};
  while (!open.empty()) {
    const ProvenanceRecord* record = open.back();
    open.pop_back();
    for (const ProvenanceInput& input : record->inputs) {
      const auto found = known.find(input.record_id);
      if (found != known.end() && ancestors.insert(*found).second) open.push_back(found->second);
    }
  }
  for (const auto& [id, record] : ancestors) part.records.push_back(*record);
  return part;
}

nlohmann::json ToJson(const Provenance& provenance) {
  nlohmann::json records = nlohmann::json::array();
  for (const ProvenanceRecord& record : provenance.records) {
    nlohmann::json one = RecordToJson(record);
    one["id"] = record.Id();
    records.push_back(std::move(one));
  }
  return records;
}

std::string JsonTextOf(const Provenance& provenance) { return JsonText(ToJson(provenance)); }

Provenance ProvenanceFromJson(const nlohmann::json& json) {
  try {
    Provenance provenance;
    for (const nlohmann::json& one : json) {
      ProvenanceRecord record;
      record.stage = one.at("stage").get<std::string>();
      record.version = one.at("version").get<std::string>();
      record.options = one.at("options").get<std::map<std::string, std::string>>();
      for (const nlohmann::json& input : one.at("inputs")) {
        record.inputs.push_back({.role = input.at("role").get<std::string>(),
                                 .sha256 = input.at("sha256").get<std::string>(),
                                 .comments_ignored = input.value("comments_ignored", false),
                                 .record_id = input.value("record", std::string())});
      }
      if (record.Id() != one.at("id").get<std::string>())
        throw DataError("provenance record of stage " + record.stage + ": its id does not match its content");
      provenance.records.push_back(std::move(record));
    }
    if (provenance.records.empty()) throw DataError("provenance: no record");
    return provenance;
  } catch (const nlohmann::json::exception& error) {
    throw DataError(std::string("provenance: ") + error.what());
  }
}

}  // namespace formats
