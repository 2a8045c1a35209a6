// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dynadjust_geoid.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace test_support {
namespace {

constexpr double kLineOfGrid_deg = -37.8;
constexpr double kReferenceLongitude_deg = 144.96;
constexpr double kMinutes = 60.0;  // of a degree: the grid's spacing

Eigen::VectorXd Terms(const Eigen::Vector2d& place) {
  const double north = (place.x() - kLineOfGrid_deg) * kMinutes;
  const double east = (place.y() - kReferenceLongitude_deg) * kMinutes;
  const double beyond = std::max(0.0, north);
  const double of_north[] = {1.0, north, north * north, std::pow(north, 3), beyond * beyond, std::pow(beyond, 3)};
  Eigen::VectorXd terms(24);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 4; ++j) terms[4 * i + j] = of_north[i] * std::pow(east, j);
  }
  return terms;
}

}  // namespace

void GeoidSurface::AddHeight(const Eigen::Vector2d& place, double height, double sigma) {
  rows_.push_back(Terms(place) / sigma);
  values_.push_back(height / sigma);
  sigmas_.push_back(sigma);
}

void GeoidSurface::AddRise(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double rise, double sigma) {
  rows_.push_back((Terms(to) - Terms(from)) / sigma);
  values_.push_back(rise / sigma);
  sigmas_.push_back(sigma);
}

double GeoidSurface::Fit() {
  const auto count = static_cast<Eigen::Index>(rows_.size());
  Eigen::MatrixXd design(count, 24);
  for (Eigen::Index i = 0; i < count; ++i) design.row(i) = rows_[static_cast<std::size_t>(i)];
  const Eigen::Map<const Eigen::VectorXd> values(values_.data(), count);
  coefficients_ = design.colPivHouseholderQr().solve(values);
  const Eigen::Map<const Eigen::ArrayXd> sigmas(sigmas_.data(), count);
  return ((values - design * coefficients_).array() * sigmas).abs().maxCoeff();
}

double GeoidSurface::Height(const Eigen::Vector2d& place) const { return Terms(place).dot(coefficients_); }

}  // namespace test_support
