// SPDX-License-Identifier: Apache-2.0
#include "stages/review/site_documents.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "pipeline/site_edits.h"
#include "pipeline/site_layout.h"

namespace review {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json Parsed(const fs::path& file, const std::string& text) {
  try {
    return formats::ParsedJson(text);
  } catch (const json::parse_error& error) {
    throw formats::DataError(file.string() + ": is not JSON: " + error.what());
  }
}

json FramesOfBlocks(const fs::path& site) {
  json frames = json::object();
  for (const std::string& block : pipeline::BlocksOf(site)) frames[block] = FrameOfBlock(site, block);
  return frames;
}

}  // namespace

json SiteDocument(const fs::path& site, TileLayers* layers) {
  return {{"name", site.filename()}, {"layers", layers->Description()}, {"basis", pipeline::BasisOf(site)}};
}

json RequestsDocument(const fs::path& site) {
  json document = {{"frames", FramesOfBlocks(site)}, {"blocks", json::array()}, {"requests", json::array()}};
  const fs::path file = site / "work" / "requests.jsonl";
  if (!fs::exists(file)) return document;
  std::istringstream lines(formats::ReadWholeFile(file));
  std::string line;
  std::getline(lines, line);
  const json head = Parsed(file, line);
  if (!head.is_object() || head.value("format", "") != "plumbline-requests")
    throw formats::DataError(file.string() + ": is no list of review requests");
  document["blocks"] = head.value("blocks", json::array());
  while (std::getline(lines, line)) document["requests"].push_back(Parsed(file, line));
  return document;
}

json ControlDocument(const fs::path& site) {
  json points = json::array();
  const fs::path file = site / "work" / "control.sqlite";
  if (!fs::exists(file)) return points;
  for (const survey::ControlPoint& point : formats::ReadControl(file).points) {
    if (point.role == survey::PointRole::kTie) continue;
    points.push_back({{"name", point.name},
                      {"role", Name(point.role)},
                      {"x", point.position_in_site.x()},
                      {"y", point.position_in_site.y()},
                      {"sigma", std::sqrt(0.5 * point.covariance.trace())}});
  }
  return points;
}

json SeamsDocument(const fs::path& site) {
  const fs::path file = site / "out" / "seams.geojson";
  if (!fs::exists(file)) return {{"type", "FeatureCollection"}, {"features", json::array()}};
  return Parsed(file, formats::ReadWholeFile(file));
}

}  // namespace review
