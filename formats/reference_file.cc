// SPDX-License-Identifier: Apache-2.0
#include "formats/reference_file.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/html.h"
#include "formats/json_text.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

using nlohmann::json;

double Rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }  // micrometres

json ToJson(const Eigen::Vector3d& v) { return {{"e", Rounded(v.x())}, {"n", Rounded(v.y())}, {"h", Rounded(v.z())}}; }

}  // namespace

void WriteReferenceReport(const std::filesystem::path& file, const survey::TargetFit& fit,
                          const std::vector<survey::MapFeature>& features, const Provenance& provenance) {
  json targets = json::array(), missing = json::array(), rows = json::array();
  for (const survey::TargetResidual& target : fit.residuals) {
    targets.push_back({{"name", target.name}, {"residual", ToJson(target.residual)}});
  }
  for (int row = 0; row < 3; ++row) {
    json values = json::array();
    for (int column = 0; column < 4; ++column) values.push_back(fit.site_from_cloud.matrix()(row, column));
    rows.push_back(std::move(values));
  }
  for (const survey::MapFeature& feature : features) {
    if (!feature.found) missing.push_back({{"name", feature.name}, {"reason", feature.reason}});
  }
  const json document = {{"format", "plumbline-reference"},
                         {"format_version", 1},
                         {"site_from_cloud", std::move(rows)},
                         {"targets", std::move(targets)},
                         {"rms_m", Rounded(fit.rms_m)},
                         {"scale_minus_one_ppm", std::round((fit.scale - 1.0) * 1e7) / 10.0 + 0.0},
                         {"scale_sigma_ppm", std::round(fit.scale_sigma * 1e7) / 10.0 + 0.0},
                         {"features_not_found", std::move(missing)},
                         {"provenance", ToJson(provenance)}};
  WriteJson(file, document);
}

void WriteSlice(const std::filesystem::path& file, const std::vector<Eigen::Vector2d>& points) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (const Eigen::Vector2d& p : points) {
    const double values[] = {p.x(), p.y(), 0.0};
    text.append(reinterpret_cast<const char*>(values), sizeof values);
  }
  WriteFileAtomically(file, text);
}

void WriteReferenceFeatures(const std::filesystem::path& file, const std::vector<survey::MapFeature>& features) {
  std::string text = "name,northing,easting,sigma_n,sigma_e,kind\n";
  for (const survey::MapFeature& feature : features) {
    if (!feature.found) continue;
    text += feature.name + "," + Fixed(feature.position_in_site.y(), 4) + "," + Fixed(feature.position_in_site.x(), 4) +
            "," + Fixed(std::sqrt(feature.covariance(1, 1)), 5) + "," + Fixed(std::sqrt(feature.covariance(0, 0)), 5) +
            "," + std::string(Name(feature.kind)) + "\n";
  }
  WriteFileAtomically(file, text);
}

}  // namespace formats
