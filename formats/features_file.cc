// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"

namespace formats {
namespace {

using survey::FeatureKind;

constexpr std::array kKinds = {FeatureKind::kCorner, FeatureKind::kPillar};

constexpr auto kFeatureRow = [](auto& row, auto& id, auto& feature) {
  row(id, feature.name, Named{feature.kind, kKinds}, feature.found, feature.reason, feature.position_in_site,
      feature.reading, feature.covariance, feature.num_cells);
};

}  // namespace

void WriteFeatures(const std::filesystem::path& file, const std::vector<survey::MapFeature>& features,
                   const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kFeatures, provenance);
  WriteRows(writer, "features", features, kFeatureRow);
  writer.Commit();
}

std::vector<survey::MapFeature> ReadFeatures(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kFeatures);
  return ReadRows<survey::MapFeature>(reader, "features", kFeatureRow);
}

}  // namespace formats
