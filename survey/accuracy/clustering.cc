// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/clustering.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "survey/accuracy/distributions.h"
#include "survey/accuracy/moments.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

constexpr std::size_t kFewestForMoran = 8;
constexpr std::size_t kNeighbours = 4;
constexpr int kPermutations = 999;

struct Pair {
  std::size_t a, b;
};

std::vector<Pair> NearestPairs(std::span<const Eigen::Vector2d> positions) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t j = 0; j < positions.size(); ++j) {
      if (j != i) others.emplace_back((positions[j] - positions[i]).squaredNorm(), j);
    }
    std::partial_sort(others.begin(), others.begin() + kNeighbours, others.end());
    for (std::size_t k = 0; k < kNeighbours; ++k) pairs.push_back({i, others[k].second});
  }
  return pairs;
}

// Mean product of neighbours; over the mean square it is Moran's I.
double MeanProduct(const std::vector<Pair>& pairs, const std::vector<Eigen::Vector2d>& deviations,
                   const std::vector<std::size_t>& order) {
  double sum = 0.0;
  for (const Pair& pair : pairs) sum += deviations[order[pair.a]].dot(deviations[order[pair.b]]);
  return sum / static_cast<double>(pairs.size());
}

void Shuffle(const RandomStream& random, std::vector<std::size_t>* order) {
  for (std::size_t i = order->size() - 1; i > 0; --i) {
    const double u = random.Uniform(i);
    std::swap((*order)[i], (*order)[static_cast<std::size_t>(u * static_cast<double>(i + 1))]);
  }
}

}  // namespace

std::optional<BlockEffect> TestBlockEffect(std::span<const Eigen::Vector2d> errors, std::span<const int> blocks) {
  std::map<int, std::vector<Eigen::Vector2d>> by_block;
  for (std::size_t i = 0; i < errors.size(); ++i) by_block[blocks[i]].push_back(errors[i]);
  const auto n = static_cast<double>(errors.size());
  const auto k = static_cast<double>(by_block.size());
  if (k < 2 || n - k < 4) return std::nullopt;
  Eigen::Matrix2d within = Eigen::Matrix2d::Zero();
  for (const auto& [block, members] : by_block) {
    within += SecondMomentAboutMean(members) * static_cast<double>(members.size());
  }
  const Eigen::Matrix2d total = SecondMomentAboutMean(errors) * n;
  if (!InverseOfSpread(within) || !InverseOfSpread(total)) return std::nullopt;
  BlockEffect effect{.num_blocks = static_cast<int>(by_block.size())};
  effect.wilks_lambda = within.determinant() / total.determinant();
  const double root = std::sqrt(effect.wilks_lambda);
  effect.f = (1.0 - root) / root * (n - k - 1.0) / (k - 1.0);
  effect.p_value = FisherUpperTail(std::max(effect.f, 0.0), 2.0 * (k - 1.0), 2.0 * (n - k - 1.0));
  return effect;
}

std::optional<MoranTest> TestMoran(std::span<const Eigen::Vector2d> positions,
                                   std::span<const Eigen::Vector2d> errors) {
  const double mean_square = SecondMomentAboutMean(errors).trace();
  if (errors.size() < kFewestForMoran || mean_square <= 0.0) return std::nullopt;
  const Eigen::Vector2d mean = MeanOf(errors);
  std::vector<Eigen::Vector2d> deviations;
  for (const Eigen::Vector2d& error : errors) deviations.emplace_back(error - mean);
  const std::vector<Pair> pairs = NearestPairs(positions);
  std::vector<std::size_t> order(errors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double observed = MeanProduct(pairs, deviations, order);
  int as_large = 0;
  for (int permutation = 0; permutation < kPermutations; ++permutation) {
    Shuffle(RandomStream(StreamOfName("moran"), 0, static_cast<std::uint32_t>(permutation)), &order);
    as_large += MeanProduct(pairs, deviations, order) >= observed ? 1 : 0;
  }
  return MoranTest{observed / mean_square, (as_large + 1.0) / (kPermutations + 1.0)};
}

}  // namespace survey
