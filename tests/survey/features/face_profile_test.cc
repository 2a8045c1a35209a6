// SPDX-License-Identifier: Apache-2.0
#include "survey/features/face_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "survey/geometry/pose2.h"
#include "tests/support/rendered_map.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using test_support::Box;
using test_support::RenderMap;

constexpr double kCell = 0.05;

// A wall 1.2 m long whose southern face is at `face_y`, seen from the south; turned about the middle of the face.
std::vector<ObservedCell> WallSeen(double face_y, double turn, double noise_m, std::uint64_t seed, int scans) {
  const auto wall = test_support::Rotated(Box(-1.0, face_y, 1.0, face_y + 0.3), turn, {0, face_y});
  const SiteRaster map = RenderMap({wall}, {{0.3, -2}, {-0.8, -3}, {1.7, -2.5}},
                                   {.range_noise_m = noise_m,
                                    .position_noise_m = 0.006,
                                    .angle_increment_rad = 0.006,
                                    .range_max_m = 6.0,
                                    .p_hit = 0.6,
                                    .p_miss = 0.45,
                                    .scans_per_stand = scans,
                                    .seed = seed});
  return CellsNear(map, {0, 0}, 1.2);
}

FacePlace Placed(const std::vector<ObservedCell>& cells, double begin_offset) {
  return PlaceFace(cells, {.normal = {0, -1}, .offset = begin_offset, .from = -0.6, .to = 0.6}, kCell);
}

// Every phase of the face in its cells: at their border a face leaves one row of cells, in their middle one, shortly
// before their end two.
TEST(PlaceFace, InEveryPhaseOfTheCellsWithinAQuarterOfACell) {
  for (const int scans : {10, 60}) {
    for (const double noise : {0.01, 0.02}) {
      double squares = 0.0;
      double normalized = 0.0;
      double sum = 0.0;
      constexpr int kPhases = 10;
      for (int phase = 0; phase < kPhases; ++phase) {
        const double face_y = phase * kCell / kPhases;
        const auto cells = WallSeen(face_y, 0.0, noise, static_cast<std::uint64_t>(phase), scans);
        const FacePlace place = Placed(cells, -kCell / 2);
        const double error = -place.offset - face_y;
        EXPECT_LT(std::abs(error), 0.36 * kCell) << "phase " << phase << ", noise " << noise << ", scans " << scans;
        EXPECT_LT(std::abs(place.normal.x()), 0.03);
        squares += error * error;
        normalized += std::pow(error / place.sigma_offset, 2);
        sum += error;
      }
      EXPECT_LT(std::sqrt(squares / kPhases), 0.22 * kCell) << "noise " << noise << ", scans " << scans;
      EXPECT_LT(std::abs(sum / kPhases), 0.12 * kCell) << "noise " << noise << ", scans " << scans;
      EXPECT_LT(std::sqrt(normalized / kPhases), 1.5) << "noise " << noise << ", scans " << scans;
      EXPECT_GT(std::sqrt(normalized / kPhases), 0.4) << "noise " << noise << ", scans " << scans;
    }
  }
}

TEST(PlaceFace, ATiltedFaceIsTurnedIntoItsDirection) {
  for (const double turn : {-0.05, 0.03, 0.06}) {
    const FacePlace place = Placed(WallSeen(0.012, turn, 0.01, 4, 30), -0.03);
    EXPECT_NEAR(std::atan2(place.normal.x(), -place.normal.y()), turn, 0.02);
    EXPECT_NEAR(-place.normal.dot(Vector2d(0, 0.012)), -place.offset, 0.2 * kCell);
  }
}

TEST(PlaceFace, TheStartDoesNotMatterWithinACell) {
  const auto cells = WallSeen(0.02, 0.0, 0.015, 9, 30);
  const FacePlace middle = Placed(cells, -0.02);
  for (const double start : {-0.055, 0.015}) EXPECT_NEAR(Placed(cells, start).offset, middle.offset, 0.006);
}

TEST(PlaceFace, WithoutACellThePlaceStaysAndIsUncertain) {
  const FacePlace place = Placed({}, -0.02);
  EXPECT_NEAR(place.offset, -0.02, 1e-9);
  EXPECT_GT(place.sigma_offset, 0.5 * kCell);
}

}  // namespace
}  // namespace survey
