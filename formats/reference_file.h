// SPDX-License-Identifier: Apache-2.0
//
// What `reference` writes: reference.json (how the cloud lies in the control frame), slice.ply (plane reference,
// double coordinates, z = 0) and features.csv (features with their sigmas, as `features` and `certify` read them).
#pragma once

#include <filesystem>
#include <vector>

#include "formats/provenance.h"
#include "survey/cloud/target_fit.h"
#include "survey/features/feature.h"

namespace formats {

void WriteReferenceReport(const std::filesystem::path& file, const survey::TargetFit& fit,
                          const std::vector<survey::MapFeature>& features, const Provenance& provenance);
void WriteSlice(const std::filesystem::path& file, const std::vector<Eigen::Vector2d>& points);

// The features that were found.
void WriteReferenceFeatures(const std::filesystem::path& file, const std::vector<survey::MapFeature>& features);

}  // namespace formats
