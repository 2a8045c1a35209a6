// SPDX-License-Identifier: Apache-2.0
//
// Least-squares adjustment of a survey network with its statistics [Ghilani17] [Gama] [DynAdjust]: 1-D, 2-D and 3-D,
// fixed, constrained and free datum. Lengths in m, angles in rad.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "survey/network/cofactors.h"
#include "survey/network/linear_system.h"
#include "survey/network/network.h"
#include "survey/stats/error_ellipse.h"
#include "survey/stats/reliability.h"

namespace survey {

enum class NetworkSolver { kSparse, kDense };

struct AdjustmentOptions {
  NetworkSolver solver = NetworkSolver::kSparse;
  TestLevel test;  // of single observations
};

// Standard deviations are a priori ones, that is for sigma zero = 1; NetworkAdjustment::Scale() makes them a
// posteriori.
struct ObservationResult {
  double adjusted = 0.0;  // m or rad, angles in [0, 2 pi)
  double residual = 0.0;  // adjusted minus observed
  double sigma_adjusted = 0.0;
  double sigma_residual = 0.0;
  double w = 0.0;                        // test statistic, normal a priori; 0 when not controlled
  double redundancy = 0.0;               // 0 not controlled .. 1
  double estimated_error = 0.0;          // of the observation if it alone is wrong
  double minimal_detectable_bias = 0.0;  // infinite when not controlled

  // Residual over its standard deviation; 0 when not controlled.
  double Standardized() const { return sigma_residual > 0.0 ? residual / sigma_residual : 0.0; }
};

struct PointResult {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // a priori; zero for what is not adjusted
};

struct NetworkAdjustment {
  bool usable = false;
  std::string message;  // why not usable
  int iterations = 0;
  int num_unknowns = 0;
  int num_observations = 0;
  int defect = 0;
  int degrees_of_freedom = 0;
  double chi_square = 0.0;                                // sum of the weighted squares, for weights 1 / sigma2
  double chi_square_lower = 0.0, chi_square_upper = 0.0;  // two-sided, at the network's confidence
  double largest_w = 0.0;
  int num_untested = 0;  // observations that nothing controls
  std::vector<PointResult> points;
  std::vector<double> orientations;  // rad, [0, 2 pi)
  std::vector<ObservationResult> observations;
  Unknowns unknowns;
  std::shared_ptr<const Cofactors> cofactors;
  double scale = 1.0;  // of standard deviations: sigma zero a posteriori over a priori, or 1

  explicit NetworkAdjustment(const Network& network) : unknowns(network) {}
  // Sigma zero a posteriori over a priori; 1 without redundancy.
  double VarianceRatioRoot() const;
  bool ChiSquareHolds() const { return chi_square >= chi_square_lower && chi_square <= chi_square_upper; }
  // Of the coordinates (3 for each point: x, y, z) of some points, scaled.
  Eigen::MatrixXd CovarianceOf(const std::vector<int>& points) const;
};

// Precondition: CheckNetwork finds nothing. All points in use must have coordinates (ComputeApproximations).
NetworkAdjustment AdjustNetwork(const Network& network, const AdjustmentOptions& options = {});

}  // namespace survey
