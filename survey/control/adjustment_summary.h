// SPDX-License-Identifier: Apache-2.0
//
// What the adjustment of a control network found, as it is kept with the control points and told in the certificate.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace survey {

struct AdjustmentSummary {
  std::string software;     // that adjusted: "Plumbline", "GNU Gama 2.11"
  std::string description;  // of the network, as its file says
  int num_observations = 0;
  int num_unknowns = 0;
  int defect = 0;  // of the datum, settled by constrained coordinates; 0: by fixed ones
  int degrees_of_freedom = 0;
  double sigma_zero_a_priori = 1.0;
  double sigma_zero = 0.0;  // a posteriori, in the same unit; 0 without redundancy
  bool degrees = false;     // angles are degrees in the network's file, else gon
  bool scaled = false;      // covariances are scaled by sigma zero a posteriori
  double confidence = 0.95;
  double chi_square = 0.0;  // of the weighted squares, and its limits at that confidence
  double chi_square_lower = 0.0;
  double chi_square_upper = 0.0;
  double critical_w = 0.0;  // of the test of single observations; 0: not tested here
  double largest_w = 0.0;
  int num_uncontrolled = 0;  // observations
  int num_suspected = 0;     // outliers among the observations, found one at a time

  bool ChiSquareHolds() const { return chi_square >= chi_square_lower && chi_square <= chi_square_upper; }
};

// An observation and what became of it: m, or rad clockwise. Standard deviations are a priori.
struct AdjustedObservation {
  std::string kind;  // Name of an ObservationKind
  std::string from, to, fore;
  bool angular = false;
  double observed = 0.0;
  double sigma = 0.0;
  double adjusted = 0.0;
  double residual = 0.0;  // adjusted minus observed
  double sigma_adjusted = 0.0;
  double w = 0.0;                                 // 0 where not controlled
  double redundancy = 0.0;                        // 0 .. 1
  std::optional<double> minimal_detectable_bias;  // nothing where not controlled
  int suspected = 0;                              // as the n-th outlier; 0: not
};

}  // namespace survey
