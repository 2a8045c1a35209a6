// SPDX-License-Identifier: Apache-2.0
//
// Do errors come in clusters? Checks of one block, or near each other, may share an error; then n checks prove less
// than n independent ones.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace survey {

// One-way analysis of variance of the error vectors by block: Wilks' lambda, whose F is exact for two axes [Rencher02]
// section 6.1.3.
struct BlockEffect {
  int num_blocks = 0;
  double wilks_lambda = 1.0;
  double f = 0.0;  // with 2 (k-1) and 2 (n-k-1) degrees of freedom
  double p_value = 1.0;
};

// `blocks` holds a number for each error. Empty with one block only or with too few errors.
std::optional<BlockEffect> TestBlockEffect(std::span<const Eigen::Vector2d> errors, std::span<const int> blocks);

// Moran's I of the error vectors over the four nearest neighbours of each check, one-sided by 999 permutations
// [Cliff81]. About zero without clusters, one when neighbours agree.
struct MoranTest {
  double i = 0.0;
  double p_value = 1.0;
};

// Eight checks or more; else empty. The permutations are always the same.
std::optional<MoranTest> TestMoran(std::span<const Eigen::Vector2d> positions, std::span<const Eigen::Vector2d> errors);

}  // namespace survey
