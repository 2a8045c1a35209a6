// SPDX-License-Identifier: Apache-2.0
#include "survey/features/locate.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/stats/philox.h"
#include "tests/support/rendered_map.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using test_support::Box;
using test_support::CellsOfHits;
using test_support::Moved;
using test_support::Polygon;
using test_support::RenderMap;
using test_support::RenderOptions;
using test_support::Rotated;

NamedFeature At(const Vector2d& p, FeatureKind kind = FeatureKind::kCorner) {
  return {.name = "F", .kind = kind, .position_in_site = p};
}

RenderOptions Noise(double range_noise_m, std::uint64_t seed) {
  return {.range_noise_m = range_noise_m,
          .position_noise_m = 0.005,
          .angle_increment_rad = 0.5 * 3.14159265358979323846 / 180.0,
          .range_max_m = 5.0,
          .p_hit = 0.6,
          .p_miss = 0.45,
          .scans_per_stand = 12,
          .seed = seed};
}

// A scene with its features' true places and the stands that see them.
struct Scene {
  std::vector<Polygon> solids;
  std::vector<Vector2d> stands;
  Vector2d truth;
};

Scene Placed(const Scene& scene, double turn, const Vector2d& by) {
  Scene placed = scene;
  for (Polygon& solid : placed.solids) solid = Moved(Rotated(solid, turn, {0, 0}), by);
  for (Vector2d& stand : placed.stands) stand = by + Rotation2(turn) * stand;
  placed.truth = by + Rotation2(turn) * scene.truth;
  return placed;
}

// Inner corner of a room, outer corner of a building, corner of a pillar, pillar.
const Scene kRoomCorner{{Box(-0.3, -0.3, 6, 0), Box(-0.3, -0.3, 0, 6)}, {{3, 2}, {1.5, 4}, {4, 4}}, {0, 0}};
const Scene kOuterCorner{{Box(-6, -6, 0, 0)}, {{2, -2}, {-2, 2.5}, {2, 2}}, {0, 0}};
const Scene kPillarCorner{{Box(-0.5, -0.5, 0, 0)}, {{3, 1}, {1, 3}, {2.5, -2}}, {0, 0}};
const Scene kPillar{{Box(-0.25, -0.25, 0.25, 0.25)}, {{3, 0.5}, {-1, 3}, {-2.5, -2}, {1, -3}}, {0, 0}};

MapFeature Read(const Scene& scene, const RenderOptions& noise, const NamedFeature& wanted,
                const LocateOptions& options = {}) {
  std::vector<Vector2d> hits;
  const SiteRaster map = RenderMap(scene.solids, scene.stands, noise, &hits);
  return LocateFeature(map, CellsOfHits(map, hits, wanted.position_in_site, options.Reach()), wanted, options);
}

struct Figures {
  int found = 0;
  double squares = 0.0;     // of the errors, m2
  double normalized = 0.0;  // squares of the errors over their sigmas

  double Rms() const { return std::sqrt(squares / found); }
  double RmsNormalized() const { return std::sqrt(normalized / (2 * found)); }
};

// Scenes at random places in the cells; `turned` also at random angles, otherwise along the cells.
Figures Repeat(const Scene& scene, FeatureKind kind, bool turned, double noise_m) {
  Figures figures;
  const RandomStream random(7, 99, turned ? 1 : 0);
  for (int i = 0; i < 6; ++i) {
    const auto index = static_cast<std::uint64_t>(10 * i);
    const double turn = turned ? random.Uniform(index, -0.8, 0.8) : 0.0;
    const Vector2d by(500000 + random.Uniform(index + 1), 5600000 + random.Uniform(index + 2));
    const Scene placed = Placed(scene, turn, by);
    const Vector2d near = placed.truth + 0.02 * Vector2d(random.Normal(index + 3), random.Normal(index + 4));
    const MapFeature feature = Read(placed, Noise(noise_m, static_cast<std::uint64_t>(i)), At(near, kind));
    EXPECT_TRUE(feature.found) << "turn " << turn << ": " << feature.reason;
    if (!feature.found) continue;
    ++figures.found;
    const Vector2d error = feature.position_in_site - placed.truth;
    figures.squares += error.squaredNorm();
    figures.normalized += error.dot(feature.reading.inverse() * error);
  }
  return figures;
}

TEST(LocateFeature, PlacesAreRightWithinASixthOfACellAndTheirSigmasHonest) {
  Figures all;
  for (const double noise : {0.01, 0.025}) {
    for (const bool turned : {false, true}) {
      const struct {
        const Scene& scene;
        FeatureKind kind;
      } cases[] = {{kRoomCorner, FeatureKind::kCorner},
                   {kOuterCorner, FeatureKind::kCorner},
                   {kPillarCorner, FeatureKind::kCorner},
                   {kPillar, FeatureKind::kPillar}};
      for (const auto& one : cases) {
        const Figures figures = Repeat(one.scene, one.kind, turned, noise);
        EXPECT_LE(figures.Rms(), 0.008) << "scene " << &one - cases << ", noise " << noise << ", turned " << turned;
        all.found += figures.found;
        all.squares += figures.squares;
        all.normalized += figures.normalized;
      }
    }
  }
  EXPECT_LT(all.Rms(), 0.004);
  EXPECT_GT(all.RmsNormalized(), 0.8);
  EXPECT_LT(all.RmsNormalized(), 1.2);
}

// Faces on the borders of the cells leave one row of wall or two, by chance: neither may draw the corner into the
// pillar or away from it.
TEST(LocateFeature, ACornerOnTheBordersOfCellsIsNotDrawnIntoThePillar) {
  Vector2d sum = Vector2d::Zero();
  constexpr int kMaps = 8;
  for (int i = 0; i < kMaps; ++i) {
    RenderOptions options = Noise(0.012, static_cast<std::uint64_t>(100 + i));
    options.position_noise_m = 0.008;
    options.scans_per_stand = 40;
    const Scene placed = Placed(kPillarCorner, 0.0, {500005, 5600021.75});
    const MapFeature feature = Read(placed, options, At(placed.truth));
    ASSERT_TRUE(feature.found) << feature.reason;
    sum += feature.position_in_site - placed.truth;
  }
  EXPECT_LT((sum / kMaps).cwiseAbs().maxCoeff(), 0.0015);
}

MapFeature ReadIn(const Scene& scene, const NamedFeature& wanted, const LocateOptions& options = {}) {
  return Read(scene, Noise(0.01, 1), wanted, options);
}

TEST(LocateFeature, ARoundPillarIsFoundByItsCircle) {
  Scene scene = kPillar;
  scene.solids.front().clear();
  for (int i = 0; i < 48; ++i) scene.solids.front().push_back(Rotation2(i * std::numbers::pi / 24) * Vector2d(0.3, 0));
  const MapFeature feature = ReadIn(scene, At({0.03, -0.02}, FeatureKind::kPillar));
  ASSERT_TRUE(feature.found) << feature.reason;
  EXPECT_LT(feature.position_in_site.norm(), 0.004);
}

TEST(LocateFeature, WhatIsNotSeenIsNotGuessed) {
  // The pillar is seen from the east alone: its western corners and its centre stay open.
  Scene scene = kPillar;
  scene.stands = {{3, 0.1}, {4, -0.1}};
  const MapFeature corner = ReadIn(scene, At({-0.25, 0.25}));
  EXPECT_FALSE(corner.found);
  EXPECT_FALSE(corner.reason.empty());
  const MapFeature pillar = ReadIn(scene, At({0, 0}, FeatureKind::kPillar));
  EXPECT_FALSE(pillar.found);
  EXPECT_EQ(pillar.reason, "too little of the pillar's outline is seen");
  EXPECT_EQ(ReadIn(scene, At({3.5, 2})).reason, "no wall of the map lies near");
  EXPECT_EQ(ReadIn(scene, At({1000, 2})).reason, "no wall of the map lies near");
}

TEST(LocateFeature, AMapWhoseHitsAreNotKnownIsNotRead) {
  std::vector<Vector2d> hits;
  const SiteRaster map = RenderMap(kPillarCorner.solids, kPillarCorner.stands, Noise(0.01, 1), &hits);
  const HitCells none = CellsOfHits(map, {}, {0, 0}, LocateOptions{}.Reach());
  EXPECT_EQ(LocateFeature(map, none, At({0, 0}), {}).reason, "fewer than two wall faces are seen");
}

TEST(LocateFeature, TheNextCornerIsNotTakenForAHiddenOne) {
  const MapFeature feature = ReadIn(kPillarCorner, At({0.4, 0.1}));
  EXPECT_FALSE(feature.found);
  EXPECT_NE(feature.reason.find("the nearest corner is 0.4"), std::string::npos) << feature.reason;
}

TEST(LocateFeature, BetweenTheTwoFacesOfAThinWallIsAmbiguous) {
  // The end of a wall 0.2 m thick, all three faces seen; the surveyed place says the middle of its end.
  const Scene scene{{Box(-3, -0.1, 0, 0.1)}, {{2, 0.1}, {-1, 2}, {-1, -2}}, {0, 0}};
  const MapFeature feature = ReadIn(scene, At({0, 0.01}), {.min_face_m = 0.1});
  EXPECT_FALSE(feature.found);
  const MapFeature north = ReadIn(scene, At({0, 0.1}), {.min_face_m = 0.1});
  if (north.found) {
    EXPECT_LT((north.position_in_site - Vector2d(0, 0.1)).norm(), 0.02);
  }
}

TEST(RefuseSharedPlaces, OfTwoFeaturesAtOnePlaceNoneIsTaken) {
  std::vector<MapFeature> features = {{.name = "A", .found = true, .position_in_site = {5, 5}},
                                      {.name = "B", .found = true, .position_in_site = {5.5, 5}},
                                      {.name = "C", .reason = "hidden", .position_in_site = {5, 5}},
                                      {.name = "D", .found = true, .position_in_site = {5.02, 5}}};
  RefuseSharedPlaces(0.03, &features);
  EXPECT_EQ(features[0].reason, "read at the same place as D");
  EXPECT_TRUE(features[1].found);
  EXPECT_EQ(features[2].reason, "hidden");
  EXPECT_FALSE(features[3].found);
  EXPECT_EQ(features[3].reason, "read at the same place as A");
}

}  // namespace
}  // namespace survey
