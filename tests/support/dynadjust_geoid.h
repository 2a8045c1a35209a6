// SPDX-License-Identifier: Apache-2.0
//
// The geoid under DynAdjust's urban network. Its grid is not at hand, but DynAdjust prints what it took from it, to
// 0.1 mm, beside heights, height differences and stations. It interpolates bicubically: on both sides of the grid's
// line at 37 48 S the same cubics in latitude and longitude, but for terms that vanish there with their slope. Found
// again from 250 printed values, the surface is sure to some hundredths of a millimetre where the stations are.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace test_support {

class GeoidSurface {
 public:
  // Places: latitude and longitude (deg); heights above the ellipsoid (m) with the sigma of their last digit.
  void AddHeight(const Eigen::Vector2d& place, double height, double sigma);
  void AddRise(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double rise, double sigma);
  // Returns the largest residual (m): more than the printed digits allow means that the surface is another one.
  double Fit();
  double Height(const Eigen::Vector2d& place) const;

 private:
  std::vector<Eigen::VectorXd> rows_;  // whitened
  std::vector<double> values_;
  std::vector<double> sigmas_;
  Eigen::VectorXd coefficients_;
};

}  // namespace test_support
