// SPDX-License-Identifier: Apache-2.0
//
// The distributions that accuracy statements need (Boost.Math, in double precision so that all machines agree).
// Probabilities lie in (0, 1); degrees of freedom are positive and need not be whole.
#pragma once

namespace survey {

double NormalCdf(double z);
double NormalQuantile(double probability);
double ChiSquareQuantile(double probability, double degrees_of_freedom);
double ChiSquareUpperTail(double value, double degrees_of_freedom);
double FisherUpperTail(double value, double numerator_dof, double denominator_dof);
double FisherQuantile(double probability, double numerator_dof, double denominator_dof);

// Probability of a larger value when the numerator has a non-centrality: the power of a test.
double NonCentralFisherUpperTail(double value, double numerator_dof, double denominator_dof, double non_centrality);

double BetaQuantile(double probability, double alpha, double beta);

// Clopper-Pearson: the largest rate that `hits` of `trials` does not contradict, one-sided at `confidence`. 1 when all
// are hits. Precondition: 0 <= hits <= trials, trials > 0.
double LargestRate(int hits, int trials, double confidence);

}  // namespace survey
