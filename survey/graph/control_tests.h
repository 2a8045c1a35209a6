// SPDX-License-Identifier: Apache-2.0
//
// Tests of the control of a block [Baarda68], on the misfit d between given coordinates and free network after the
// best rigid motion. M = covariance of d, G = derivative by the datum, W = M^-1:
//   Wt = W - W G (G'WG)^-1 G'W,   chi-square = d' Wt d with 2n - 3 degrees of freedom.
// An error of given coordinates b in the marks that E selects (two columns) is tested by
//   k = E' Wt d,  K = E' Wt E,  T = k' K^-1 k ~ chi-square(2),   b = K^-1 k with covariance K^-1.
// K is P Qvv P of the whole adjustment, -b the residual that the marks show when they are left out.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "survey/graph/control_misfit.h"
#include "survey/stats/reliability.h"

namespace survey {

struct ErrorTest {
  double t = 0.0;
  int degrees_of_freedom = 2;            // fewer where the others control the marks in one direction or none
  std::optional<Eigen::Vector2d> error;  // of the given coordinates, m; empty where it is not determined
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of `error`
  std::optional<double> minimal_detectable;              // m, in the direction in which it is largest
  Eigen::Vector2d worst_direction = Eigen::Vector2d::Zero();
};

class ControlTests {
 public:
  // Of the marks at the places `kept` of the misfit, ascending. `misfit` must outlive this.
  ControlTests(const ControlMisfit& misfit, std::vector<int> kept);

  // False: fewer than two places, or a covariance that is not positive definite.
  bool usable() const { return usable_; }
  const std::vector<int>& kept() const { return kept_; }

  double chi_square() const { return misfit_of_kept_.dot(weighted_); }
  int degrees_of_freedom() const { return static_cast<int>(misfit_of_kept_.size()) - 3; }

  // One common error of all these marks (places in the misfit, all kept).
  ErrorTest Test(std::span<const int> marks, const TestLevel& level) const;

  // Share of the mark's coordinates that the others control, 0 to 1: tr(Qvv S^-1) / 2.
  double RedundancyOf(int mark) const;

  // chi-square if the given coordinates of two marks were exchanged, and then T of both.
  struct Exchange {
    double chi_square = 0.0;
    double t_a = 0.0;
    double t_b = 0.0;
  };
  Exchange IfExchanged(int a, int b) const;

  // Largest shift of a pose (m) by this error of a mark's given coordinates.
  double LargestShift(int mark, const Eigen::Vector2d& error) const;

  // Scale of the network against the control, minus one, and its sigma.
  struct Scale {
    double deviation = 0.0;
    double sigma = 0.0;
  };
  Scale EstimateScale() const;

  // Variance components [Foerstner79] of control and marks as an observation kind, and of the network as the other:
  // the redundancies of both sum to the degrees of freedom.
  struct Component {
    double squares = 0.0;
    double redundancy = 0.0;
  };
  Component ComponentOfControl() const { return ComponentOf(own_covariance_); }
  Component ComponentOfNetwork() const;

 private:
  Eigen::Index RowOf(int mark) const;
  Component ComponentOf(const Eigen::MatrixXd& covariance) const;

  const ControlMisfit& misfit_;
  std::vector<int> kept_;
  bool usable_ = false;
  Eigen::VectorXd misfit_of_kept_;
  Eigen::MatrixXd own_covariance_;                            // of marks and control
  Eigen::MatrixXd weight_;                                    // Wt
  Eigen::VectorXd weighted_;                                  // Wt d
  Eigen::Matrix<double, 3, Eigen::Dynamic> datum_by_misfit_;  // (G'WG)^-1 G'W
};

}  // namespace survey
