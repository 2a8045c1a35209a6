// SPDX-License-Identifier: Apache-2.0
#include "formats/seam_summary.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"

namespace formats {

using nlohmann::json;

std::vector<survey::SeamSummary> ReadSeamSummaries(const std::filesystem::path& file) {
  const json document = JsonOrDiscarded(ReadWholeFile(file));
  try {
    if (!document.is_object() || document.at("format") != "plumbline-seams" || document.at("format_version") != 2) {
      throw DataError(file.string() + ": is not a seams.json of this version (or was cut off)");
    }
    std::vector<survey::SeamSummary> summaries;
    for (const json& seam : document.at("seams")) {
      const json& rms = seam.at("rms_m");
      const json& sigmas = seam.at("sigmas");
      const json& verdict = seam.at("contradicts");
      const json& contradicted = seam.at("contradicted_shares");
      summaries.push_back(
          {.block_a = seam.at("blocks").at(0).get<std::string>(),
           .block_b = seam.at("blocks").at(1).get<std::string>(),
           .overlap_area_m2 = seam.at("overlap_area_m2").get<double>(),
           .num_windows = static_cast<int>(seam.at("patches").size()),
           .rms = rms.is_null() ? std::nullopt : std::optional<double>(rms.get<double>()),
           .contradicted_share = std::max(contradicted.at(0).get<double>(), contradicted.at(1).get<double>()),
           .sigmas = sigmas.is_null() ? std::nullopt : std::optional<double>(sigmas.get<double>()),
           .contradicts = verdict.is_null() ? std::nullopt : std::optional<bool>(verdict.get<bool>())});
    }
    return summaries;
  } catch (const json::exception& error) {
    throw DataError(file.string() + ": " + error.what());
  }
}

}  // namespace formats
