// SPDX-License-Identifier: Apache-2.0
//
// Simulated networks with known truth: a street grid of stations, each with directions to its four neighbours and
// distances to two of them.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <chrono>
#include <cmath>

#include "survey/network/adjustment.h"
#include "survey/network/approximations.h"
#include "survey/network/network_checks.h"
#include "survey/network/outliers.h"
#include "survey/stats/philox.h"

namespace {

using survey::CoordinateUse;
using survey::Network;
using survey::NetworkAdjustment;
using survey::NetworkSolver;
using survey::ObservationKind;

constexpr double kSpacing = 30.0, kSigmaDirection = 5e-6, kSigmaDistance = 0.001;

struct GridNetwork {
  Network network;
  std::vector<Eigen::Vector3d> truth;
};

enum class GridDatum { kFixedCorners, kFree };

GridNetwork MakeGrid(int size, GridDatum datum, std::uint64_t seed) {
  GridNetwork grid;
  const survey::RandomStream random(seed, 0, 0);
  std::uint64_t draw = 0;
  const auto noise = [&](double sigma) { return sigma * random.Normal(draw++); };
  const auto index = [&](int row, int column) { return row * size + column; };
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const Eigen::Vector3d p(kSpacing * column + noise(3.0), kSpacing * row + noise(3.0), 0.0);
      const bool corner = (row == 0 || row == size - 1) && (column == 0 || column == size - 1);
      const CoordinateUse use = datum == GridDatum::kFree ? CoordinateUse::kConstrained
                                : corner                  ? CoordinateUse::kFixed
                                                          : CoordinateUse::kAdjusted;
      const Eigen::Vector3d given =
          use == CoordinateUse::kFixed ? p : Eigen::Vector3d(p.x() + noise(0.05), p.y() + noise(0.05), 0.0);
      grid.truth.push_back(p);
      grid.network.points.push_back({.name = std::to_string(row) + "." + std::to_string(column),
                                     .plane = use,
                                     .position = given,
                                     .plane_known = true});
    }
  }
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const int set = grid.network.num_sets++, from = index(row, column);
      const double orientation = 2.0 * M_PI * static_cast<double>(draw % 97) / 97.0;
      const auto observe = [&](int to_row, int to_column, bool with_distance) {
        if (to_row < 0 || to_column < 0 || to_row >= size || to_column >= size) return;
        const int to = index(to_row, to_column);
        const Eigen::Vector3d d = grid.truth[static_cast<std::size_t>(to)] - grid.truth[static_cast<std::size_t>(from)];
        grid.network.observations.push_back({.kind = ObservationKind::kDirection,
                                             .from = from,
                                             .to = to,
                                             .set = set,
                                             .value = std::atan2(d.x(), d.y()) - orientation + noise(kSigmaDirection),
                                             .sigma = kSigmaDirection});
        if (!with_distance) return;
        grid.network.observations.push_back({.kind = ObservationKind::kDistance,
                                             .from = from,
                                             .to = to,
                                             .value = d.norm() + noise(kSigmaDistance),
                                             .sigma = kSigmaDistance});
      };
      observe(row, column + 1, true);
      observe(row + 1, column, true);
      observe(row, column - 1, false);
      observe(row - 1, column, false);
    }
  }
  grid.network.use_sigma_a_posteriori = false;
  return grid;
}

void ExpectSameAdjustment(const Network& network, const NetworkAdjustment& a, const NetworkAdjustment& b) {
  ASSERT_TRUE(a.usable && b.usable) << a.message << b.message;
  EXPECT_EQ(a.defect, b.defect);
  EXPECT_EQ(a.degrees_of_freedom, b.degrees_of_freedom);
  EXPECT_NEAR(a.chi_square, b.chi_square, 1e-7 * a.chi_square);
  std::vector<int> all;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    all.push_back(static_cast<int>(i));
    EXPECT_LT((a.points[i].position - b.points[i].position).norm(), 1e-7) << network.points[i].name;
    EXPECT_LE((a.points[i].covariance - b.points[i].covariance).norm(), 1e-6 * a.points[i].covariance.norm());
  }
  const Eigen::MatrixXd covariance = a.CovarianceOf(all);
  EXPECT_LT((covariance - b.CovarianceOf(all)).norm(), 1e-6 * covariance.norm());
  for (std::size_t k = 0; k < a.observations.size(); ++k) {
    EXPECT_NEAR(a.observations[k].w, b.observations[k].w, 1e-4);
    EXPECT_NEAR(a.observations[k].redundancy, b.observations[k].redundancy, 1e-6);
  }
}

TEST(GridNetworkTest, SparseAndDenseAgree) {
  for (const GridDatum datum : {GridDatum::kFixedCorners, GridDatum::kFree}) {
    const GridNetwork grid = MakeGrid(7, datum, 1);
    const NetworkAdjustment sparse = AdjustNetwork(grid.network, {.solver = NetworkSolver::kSparse});
    ExpectSameAdjustment(grid.network, sparse, AdjustNetwork(grid.network, {.solver = NetworkSolver::kDense}));
    EXPECT_EQ(sparse.defect, datum == GridDatum::kFree ? 3 : 0);
    // Redundancy numbers add up to the degrees of freedom.
    double sum = 0.0;
    for (const survey::ObservationResult& o : sparse.observations) sum += o.redundancy;
    EXPECT_NEAR(sum, sparse.degrees_of_freedom, 1e-6);
  }
}

// Truth within what the covariances promise: sums of squared, standardised errors of many networks.
TEST(GridNetworkTest, CovariancesCoverTheTruth) {
  double sum = 0.0, chi_square = 0.0;
  int count = 0, degrees_of_freedom = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const GridNetwork grid = MakeGrid(5, GridDatum::kFixedCorners, seed);
    const NetworkAdjustment adjustment = AdjustNetwork(grid.network);
    ASSERT_TRUE(adjustment.usable);
    chi_square += adjustment.chi_square;
    degrees_of_freedom += adjustment.degrees_of_freedom;
    for (const std::size_t i : {std::size_t{7}, std::size_t{12}, std::size_t{16}}) {
      const Eigen::Vector2d error = (adjustment.points[i].position - grid.truth[i]).head<2>();
      sum += error.dot(adjustment.points[i].covariance.topLeftCorner<2, 2>().inverse() * error);
      count += 2;
    }
  }
  EXPECT_NEAR(sum / count, 1.0, 0.35);  // 240 values; points of one network are correlated
  EXPECT_NEAR(chi_square / degrees_of_freedom, 1.0, 0.1);
}

// A blunder of the size of the MDB is found with the promised power, 80 %, and named; one at a time also two of them.
TEST(GridNetworkTest, OutliersOneAtATime) {
  GridNetwork grid = MakeGrid(6, GridDatum::kFixedCorners, 3);
  const NetworkAdjustment clean = AdjustNetwork(grid.network);
  ASSERT_TRUE(FindOutliers(grid.network, clean, {}, 10).empty());
  grid.network.observations[40].value += 3.0 * clean.observations[40].minimal_detectable_bias;
  grid.network.observations[95].value -= 2.0 * clean.observations[95].minimal_detectable_bias;
  const auto outliers = FindOutliers(grid.network, AdjustNetwork(grid.network), {}, 10);
  ASSERT_EQ(outliers.size(), 2U);
  EXPECT_EQ(outliers[0].observation, 40U);
  EXPECT_EQ(outliers[1].observation, 95U);
  EXPECT_NEAR(outliers[1].estimated_error, -2.0 * clean.observations[95].minimal_detectable_bias,
              1.0 * clean.observations[95].minimal_detectable_bias);

  int found = 0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    GridNetwork one = MakeGrid(4, GridDatum::kFixedCorners, 100 + static_cast<std::uint64_t>(trial));
    const std::size_t k = static_cast<std::size_t>(trial) % one.network.observations.size();
    const double mdb = AdjustNetwork(one.network).observations[k].minimal_detectable_bias;
    if (!std::isfinite(mdb)) {
      ++found;
      continue;
    }
    one.network.observations[k].value += mdb;
    if (std::abs(AdjustNetwork(one.network).observations[k].w) > survey::CriticalW(0.001)) ++found;
  }
  EXPECT_NEAR(static_cast<double>(found) / kTrials, 0.8, 0.17);  // three standard deviations of the binomial
}

// Without coordinates of the inner points: polar points, and from corner to corner.
TEST(GridNetworkTest, ApproximateCoordinates) {
  GridNetwork grid = MakeGrid(6, GridDatum::kFixedCorners, 5);
  for (survey::NetworkPoint& point : grid.network.points) {
    if (point.plane == CoordinateUse::kFixed) continue;
    point.plane_known = false;
    point.position.setZero();
  }
  ASSERT_TRUE(survey::CheckNetwork(grid.network).empty());
  ASSERT_TRUE(survey::ComputeApproximations(&grid.network).empty());
  for (std::size_t i = 0; i < grid.truth.size(); ++i) {
    EXPECT_LT((grid.network.points[i].position - grid.truth[i]).norm(), 0.1) << grid.network.points[i].name;
  }
}

// Not part of a test run: the figures of a large network.
//   survey_network_grid_network_test --gtest_also_run_disabled_tests --gtest_filter='*TenThousand*'
TEST(GridNetworkTest, DISABLED_TenThousandPoints) {
  const GridNetwork grid = MakeGrid(100, GridDatum::kFixedCorners, 7);
  const auto start = std::chrono::steady_clock::now();
  const NetworkAdjustment adjustment = AdjustNetwork(grid.network);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ASSERT_TRUE(adjustment.usable) << adjustment.message;
  double worst = 0.0, redundancy = 0.0;
  for (std::size_t i = 0; i < grid.truth.size(); ++i) {
    worst = std::max(worst, (adjustment.points[i].position - grid.truth[i]).norm());
  }
  for (const survey::ObservationResult& o : adjustment.observations) redundancy += o.redundancy;
  std::printf(
      "%d observations, %d unknowns, %d iterations: %.1f s; worst error %.4f m; sigma zero %.4f; redundancy %.3f of "
      "%d\n",
      adjustment.num_observations, adjustment.num_unknowns, adjustment.iterations, seconds, worst,
      adjustment.VarianceRatioRoot(), redundancy, adjustment.degrees_of_freedom);
  EXPECT_NEAR(redundancy, adjustment.degrees_of_freedom, 1e-3);
}

}  // namespace
