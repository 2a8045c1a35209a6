// SPDX-License-Identifier: Apache-2.0
#include "formats/features_csv.h"

#include <map>
#include <string>

#include "formats/csv.h"
#include "formats/errors.h"

namespace formats {
namespace {

using survey::FeatureKind;
using survey::NamedFeature;

enum Column { kName, kNorthing, kEasting, kSigmaN, kSigmaE, kKind };

double SigmaOf(const CsvReader& csv, Column column) {
  const double sigma = csv.Number(column);
  if (sigma < 0) csv.Fail(column, "a sigma must not be negative");
  return sigma;
}

FeatureKind KindOf(const CsvReader& csv) {
  for (const FeatureKind kind : {FeatureKind::kCorner, FeatureKind::kPillar}) {
    if (csv.Text(kKind) == Name(kind)) return kind;
  }
  csv.Fail(kKind, "must be corner or pillar");
}

}  // namespace

std::vector<NamedFeature> ReadFeaturesCsv(const std::filesystem::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"name", "northing", "easting", "sigma_n", "sigma_e", "kind"});
  std::vector<NamedFeature> features;
  std::map<std::string, int> row_of;
  while (csv.NextRow()) {
    NamedFeature feature{.name = std::string(csv.Text(kName)), .kind = KindOf(csv)};
    feature.position_in_site = {csv.Number(kEasting), csv.Number(kNorthing)};
    const double sigma_e = SigmaOf(csv, kSigmaE);
    const double sigma_n = SigmaOf(csv, kSigmaN);
    feature.covariance.diagonal() << sigma_e * sigma_e, sigma_n * sigma_n;
    const auto [other, fresh] = row_of.emplace(feature.name, csv.row());
    if (!fresh) csv.Fail(kName, "stands in row " + std::to_string(other->second) + " too");
    features.push_back(std::move(feature));
  }
  return features;
}

}  // namespace formats
