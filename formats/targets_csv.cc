// SPDX-License-Identifier: Apache-2.0
#include "formats/targets_csv.h"

#include <algorithm>

#include "formats/csv.h"
#include "formats/errors.h"

namespace formats {
namespace {

enum Column { kName, kNorthing, kEasting, kElevation, kSigma, kRadius };

}  // namespace

TargetList ReadTargetsCsv(const std::filesystem::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"target", "northing", "easting", "elevation", "sigma_m", "radius_m"});
  TargetList list;
  while (csv.NextRow()) {
    survey::KnownTarget target{.name = std::string(csv.Text(kName)), .sigma_m = csv.Number(kSigma)};
    target.position_in_site = {csv.Number(kEasting), csv.Number(kNorthing), csv.Number(kElevation)};
    const double radius = csv.Number(kRadius);
    if (!(target.sigma_m >= 0.0)) csv.Fail(kSigma, "a sigma must not be negative");
    if (radius == 0.0) {
      list.has_boards = true;
    } else {
      if (!(radius >= 0.01 && radius <= 1.0)) csv.Fail(kRadius, "must be 0.01 to 1 m, or 0 for a checkerboard");
      if (list.radius_m != 0.0 && radius != list.radius_m) csv.Fail(kRadius, "all spheres must have one radius");
      list.radius_m = radius;
    }
    const bool twice = std::any_of(list.targets.begin(), list.targets.end(),
                                   [&](const survey::KnownTarget& other) { return other.name == target.name; });
    if (twice) csv.Fail(kName, "is listed twice");
    list.targets.push_back(std::move(target));
  }
  return list;
}

}  // namespace formats
