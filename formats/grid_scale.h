// SPDX-License-Identifier: Apache-2.0
//
// From distances on the ground to distances in a projected system: combined factor = point scale of the projection
// times R / (R + h), R the Gaussian mean radius, h the height above the ellipsoid [survey practice: ground times factor
// = grid].
#pragma once

#include <Eigen/Core>
#include <string>

namespace formats {

struct GridScale {
  double projection = 1.0;  // grid over ellipsoid
  double height = 1.0;      // ellipsoid over ground
  double radius_m = 0.0;    // R
  double Combined() const { return projection * height; }
};

// At a place in the projected system. UsageError when the CRS is not projected; DataError when the place lies outside
// of what the projection can invert.
GridScale GridScaleAt(const std::string& crs, const Eigen::Vector2d& east_north, double ellipsoidal_height_m);

}  // namespace formats
