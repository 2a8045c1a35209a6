// SPDX-License-Identifier: Apache-2.0
#include "survey/features/face_place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/stats/philox.h"
#include "tests/support/rendered_map.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using test_support::Box;
using test_support::CellsOfHits;
using test_support::RenderMap;

constexpr double kCell = 0.05;

// A wall 2 m long whose southern face is at `face_y`, seen from the south; turned about the middle of the face.
std::vector<HitCell> WallSeen(double face_y, double turn, double noise_m, std::uint64_t seed) {
  const auto wall = test_support::Rotated(Box(-1.0, face_y, 1.0, face_y + 0.3), turn, {0, face_y});
  std::vector<Vector2d> hits;
  const SiteRaster map = RenderMap(
      {wall}, {{0.3, -2}, {-0.8, -3}, {1.7, -2.5}},
      {.range_noise_m = noise_m, .angle_increment_rad = 0.006, .range_max_m = 6.0, .scans_per_stand = 10, .seed = seed},
      &hits);
  return CellsOfHits(map, hits, {0, 0}, 1.2).Near({0, 0}, 1.2);
}

std::optional<FacePlace> Placed(const std::vector<HitCell>& cells, double begin_offset) {
  return PlaceFace(cells, {.normal = {0, -1}, .offset = begin_offset, .from = -0.6, .to = 0.6}, kCell);
}

// One wall seen from one side, in every phase of the cells and at angles to them: no side is preferred, and the sigmas
// say how far the places are off.
TEST(PlaceFace, InEveryPhaseAndDirectionWithoutBias) {
  double sum = 0.0;
  double squares = 0.0;
  double normalized = 0.0;
  double normalized_turn = 0.0;
  int count = 0;
  for (const double noise : {0.01, 0.02}) {
    for (const double turn : {-0.06, 0.0, 0.03}) {
      for (int phase = 0; phase < 6; ++phase, ++count) {
        const double face_y = phase * kCell / 6;
        const auto place = Placed(WallSeen(face_y, turn, noise, static_cast<std::uint64_t>(count)), -kCell / 2);
        ASSERT_TRUE(place);
        const double error = place->offset - place->normal.dot(Vector2d(0, face_y));
        const double turn_error = std::atan2(place->normal.x(), -place->normal.y()) - turn;
        sum += error;
        squares += error * error;
        normalized += std::pow(error / place->sigma_offset, 2);
        normalized_turn += std::pow(turn_error / place->sigma_angle, 2);
      }
    }
  }
  EXPECT_LT(std::abs(sum / count), 0.0007);
  EXPECT_LT(std::sqrt(squares / count), 0.002);
  EXPECT_GT(std::sqrt(normalized / count), 0.7);
  EXPECT_LT(std::sqrt(normalized / count), 1.3);
  EXPECT_GT(std::sqrt(normalized_turn / count), 0.7);
  EXPECT_LT(std::sqrt(normalized_turn / count), 1.3);
}

TEST(PlaceFace, TheStartDoesNotMatterWithinACell) {
  const auto cells = WallSeen(0.02, 0.0, 0.015, 9);
  const auto middle = Placed(cells, -0.02);
  ASSERT_TRUE(middle);
  for (const double start : {-0.055, 0.015}) EXPECT_NEAR(Placed(cells, start)->offset, middle->offset, 0.0015);
}

// Columns that err alike over a tenth of a metre: by their scatter alone the normalised error would be 2.4.
TEST(PlaceFace, NeighboursThatErrAlikeCountLess) {
  constexpr double kCorrelation = 0.7;
  double normalized = 0.0;
  constexpr int kFaces = 200;
  for (std::uint32_t face = 0; face < kFaces; ++face) {
    const RandomStream random(5, 1, face);
    std::vector<HitCell> cells;
    double error = 0.004 * random.Normal(1000);
    for (std::uint64_t i = 0; i < 40; ++i) {
      cells.push_back({{-0.5 + 0.025 * (static_cast<double>(i) + 0.5), error}, 20.0});
      error = kCorrelation * error + 0.004 * std::sqrt(1 - kCorrelation * kCorrelation) * random.Normal(i);
    }
    const auto place = PlaceFace(cells, {.normal = {0, -1}, .from = -0.5, .to = 0.5}, kCell);
    ASSERT_TRUE(place);
    normalized += std::pow(place->offset / place->sigma_offset, 2);
  }
  EXPECT_GT(std::sqrt(normalized / kFaces), 0.85);
  EXPECT_LT(std::sqrt(normalized / kFaces), 1.4);
}

TEST(PlaceFace, WhatStandsBesideTheFaceDoesNotCount) {
  auto cells = WallSeen(0.02, 0.0, 0.01, 3);
  const auto alone = Placed(cells, -0.03);
  for (double x = -0.3; x < 0.3; x += kCell) cells.push_back({{x, -0.1}, 500.0});
  ASSERT_TRUE(alone);
  EXPECT_NEAR(Placed(cells, -0.03)->offset, alone->offset, 1e-9);
}

TEST(PlaceFace, WithoutHitsThereIsNone) {
  EXPECT_FALSE(Placed({}, -0.02));
  EXPECT_FALSE(Placed({{{0.0, 0.02}, 100.0}, {{0.05, 0.02}, 100.0}}, -0.02));
}

}  // namespace
}  // namespace survey
