// SPDX-License-Identifier: Apache-2.0
//
// Reliability of least squares [Baarda68]: what a test of one observation can find. An observation i of weight matrix P
// with the residuals' cofactors Qvv is tested by w = (Pv)_i / sqrt((P Qvv P)_ii), normal when nothing is wrong; a pair
// of coordinates by T = v' Qvv^-1 v, chi-square with 2 degrees of freedom. A bias that shifts the test's distribution
// by the non-centrality lambda0 is found with the power asked for.
#pragma once

#include <Eigen/Core>

namespace survey {

struct TestLevel {
  double significance = 0.001;  // probability of rejecting a good observation
  double power = 0.8;           // probability of finding a bias as large as the minimal detectable one
};

// Of |w|: 3.29 for 0.001.
double CriticalW(double significance);
// Of T with this many degrees of freedom: 13.82 for 2 and 0.001.
double CriticalT(double significance, int degrees_of_freedom);

// lambda0: 17.07 for one, 19.66 for two degrees of freedom at the default level.
double NonCentrality(const TestLevel& level, int degrees_of_freedom);

// 1-D: the smallest bias of an observation that the test finds; infinite where nothing controls it. `p_qvv_p` is
// (P Qvv P)_ii, which is redundancy / sigma2 for an uncorrelated observation.
double MinimalDetectableBias(double p_qvv_p, double non_centrality);

// 2-D: in the direction in which it is largest. Covariance of the observation, and of its residuals.
double MinimalDetectableBias(const Eigen::Matrix2d& covariance, const Eigen::Matrix2d& residual_covariance,
                             double non_centrality);

}  // namespace survey
