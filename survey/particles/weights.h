// SPDX-License-Identifier: Apache-2.0
//
// Importance weights of particles, kept as logarithms: normalisation, effective sample size [Grisetti07] eq. (18),
// systematic resampling.
#pragma once

#include <span>
#include <vector>

namespace survey {

// Brings the sum of exp(log weight) to 1. False, and all weights equal, when none is finite: the filter has lost its
// way.
bool NormalizeLogWeights(std::vector<double>* log_weights);

// 1 / sum of squared weights, [AS] eq. (3): between 1 and their number. Normalised weights.
double EffectiveSampleSize(std::span<const double> log_weights);

// Of which particle each new one is a copy, ascending: a comb of equal teeth over the cumulated weights, shifted by
// `uniform` of [0, 1) of a tooth. Normalised weights.
std::vector<int> SystematicResampling(std::span<const double> log_weights, double uniform);

}  // namespace survey
