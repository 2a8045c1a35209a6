// SPDX-License-Identifier: Apache-2.0
//
// A scanner's cloud from simulated surfaces: spheres, targets, features.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "survey/cloud/checkerboard_targets.h"
#include "survey/cloud/slice.h"
#include "survey/cloud/sphere_targets.h"
#include "survey/cloud/target_fit.h"
#include "survey/features/reference_feature.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.0725;
constexpr double kNoise = 0.002;

const std::vector<Vector3d> kCentres = {{0, 0, 1}, {6, 1, 1.3}, {2, 7, 0.8}, {9, 8, 1.9}, {-4, 5, 1.1}};

// The half of a sphere that a scanner at the origin's side sees, and a wall behind.
std::vector<Eigen::Vector3f> Cloud(const std::vector<Vector3d>& centres) {
  const RandomStream random(5, 0, 0);
  std::vector<Eigen::Vector3f> cloud;
  std::uint64_t draw = 0;
  for (const Vector3d& centre : centres) {
    for (int i = 0; i < 500; ++i) {
      Vector3d direction;
      for (int axis = 0; axis < 3; ++axis) direction[axis] = random.Normal(draw++);
      direction.normalize();
      if (direction.x() > 0) direction.x() = -direction.x();
      cloud.push_back((centre + (kRadius + kNoise * random.Normal(draw++)) * direction).cast<float>());
    }
  }
  for (int i = 0; i < 20000; ++i) {
    const auto [u, v] = random.Uniforms(draw++);
    cloud.push_back(Vector3d(20 * u - 8, 12 + kNoise * random.Normal(draw++), 3 * v).cast<float>());
  }
  return cloud;
}

TEST(SphereTargetsTest, FindsAllAndNothingElse) {
  const std::vector<SphereTarget3> spheres = FindSpheres(Cloud(kCentres), {.radius_m = kRadius});
  ASSERT_EQ(spheres.size(), kCentres.size());
  for (const Vector3d& centre : kCentres) {
    double nearest = 1.0;
    for (const SphereTarget3& sphere : spheres) nearest = std::min(nearest, (sphere.centre - centre).norm());
    EXPECT_LT(nearest, 0.0008);  // 500 points of 2 mm, seen from one side
  }
  for (const SphereTarget3& sphere : spheres) EXPECT_NEAR(sphere.rms_m, kNoise, 0.0004);
}

TEST(SphereTargetsTest, ABallOfAnotherSizeIsNoTarget) {
  EXPECT_TRUE(FindSpheres(Cloud({{0, 0, 1}}), {.radius_m = 0.1}).empty());
}

struct ShadedCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensities;
};

// A flat patch of wall, 0.6 m x 0.6 m with a point every 4 mm, its shade by place; the scanner errs across it.
template <typename Shade>
void AddPatch(const Eigen::Isometry3d& cloud_from_patch, std::uint32_t stream, const Shade& shade, ShadedCloud* cloud) {
  const RandomStream random(6, 0, stream);
  std::uint64_t draw = 0;
  for (double x = -0.298; x < 0.3; x += 0.004) {
    for (double y = -0.298; y < 0.3; y += 0.004) {
      const auto [across, grey] = random.Normals(draw++);
      cloud->points.push_back((cloud_from_patch * Vector3d(x, y, kNoise * across)).cast<float>());
      cloud->intensities.push_back(static_cast<float>(shade(x, y) + 12.0 * grey));
    }
  }
}

// Four squares about the middle, the wall around them in between.
double ShadeOfBoard(double x, double y) {
  if (std::max(std::abs(x), std::abs(y)) > 0.075) return 90.0;
  return (x > 0.0) == (y > 0.0) ? 200.0 : 30.0;
}

const std::vector<Eigen::Isometry3d>& Boards() {
  static const std::vector<Eigen::Isometry3d> kBoards = {
      Eigen::Translation3d(3.02, 1.17, 1.4) * Eigen::AngleAxisd(1.3, Vector3d(0.2, 1.0, 0.1).normalized()),
      Eigen::Translation3d(-4.41, 6.33, 0.9) * Eigen::AngleAxisd(0.5, Vector3d(1.0, 0.0, 0.4).normalized())};
  return kBoards;
}

TEST(BoardTargetsTest, FindsTheCentresAndNoOtherPattern) {
  ShadedCloud cloud;
  for (const Eigen::Isometry3d& board : Boards()) AddPatch(board, 1, &ShadeOfBoard, &cloud);
  // A stripe, an edge between two paints, a dark socket.
  const auto at = [](double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, -5.0, 1.0)); };
  AddPatch(
      at(0.0), 2, [](double x, double) { return std::abs(x) < 0.04 ? 200.0 : 30.0; }, &cloud);
  AddPatch(
      at(2.0), 3, [](double x, double y) { return x + 0.3 * y > 0.0 ? 200.0 : 30.0; }, &cloud);
  AddPatch(
      at(4.0), 4, [](double x, double y) { return std::hypot(x, y) < 0.04 ? 30.0 : 200.0; }, &cloud);
  const std::vector<BoardTarget> found = FindBoards(cloud.points, cloud.intensities, {.size_m = 0.15});
  ASSERT_EQ(found.size(), Boards().size());
  for (const Eigen::Isometry3d& board : Boards()) {
    double nearest = 1.0;
    for (const BoardTarget& target : found) nearest = std::min(nearest, (target.centre - board.translation()).norm());
    EXPECT_LT(nearest, 0.0015);
  }
  std::fill(cloud.intensities.begin(), cloud.intensities.end(), std::nanf(""));
  EXPECT_TRUE(FindBoards(cloud.points, cloud.intensities, {.size_m = 0.15}).empty());
}

Eigen::Isometry3d SiteFromCloud() {
  Eigen::Isometry3d transform = Eigen::Translation3d(500123.4, 5600234.5, 112.3) *
                                Eigen::AngleAxisd(1.9, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.01, Vector3d::UnitX());
  return transform;
}

std::vector<KnownTarget> Known(const std::vector<Vector3d>& centres) {
  std::vector<KnownTarget> targets;
  for (const Vector3d& centre : centres) {
    targets.push_back({.name = "S" + std::to_string(targets.size() + 1), .position_in_site = SiteFromCloud() * centre});
  }
  return targets;
}

TEST(TargetFitTest, MatchesByDistancesWhateverTheOrder) {
  std::vector<Vector3d> spheres = {kCentres[3], {30, 30, 1}, kCentres[0], kCentres[4], kCentres[2], kCentres[1]};
  std::vector<KnownTarget> targets = Known(kCentres);
  targets[2].position_in_site.x() += 0.003;
  const TargetFit fit = FitTargets(spheres, targets, {});
  ASSERT_TRUE(fit.usable) << fit.message;
  ASSERT_EQ(fit.residuals.size(), 5U);
  EXPECT_EQ(fit.residuals[0].sphere, 2);
  EXPECT_EQ(fit.residuals[3].sphere, 0);
  EXPECT_LT((fit.site_from_cloud.translation() - SiteFromCloud().translation()).norm(), 0.004);
  EXPECT_LT(fit.rms_m, 0.003);
  EXPECT_GT(fit.rms_m, 0.0005);
  EXPECT_NEAR(fit.scale, 1.0, 5e-4);
}

TEST(TargetFitTest, NamesWhatIsWrong) {
  const std::vector<KnownTarget> targets = Known(kCentres);
  std::vector<Vector3d> spheres = kCentres;
  EXPECT_NE(FitTargets(std::span(spheres).first(2), targets, {}).message.find("fewer than three targets"),
            std::string::npos);
  EXPECT_NE(FitTargets(spheres, std::span(targets).first(2), {}).message.find("needs three targets"),
            std::string::npos);
  for (Vector3d& p : spheres) std::swap(p.x(), p.y());
  EXPECT_NE(FitTargets(spheres, targets, {}).message.find("mirror image"), std::string::npos);
  spheres = kCentres;
  for (Vector3d& p : spheres) p *= 1000.0;
  EXPECT_NE(FitTargets(spheres, targets, {}).message.find("millimetres"), std::string::npos);
  spheres = kCentres;
  for (Vector3d& p : spheres) p *= 1.001;  // 12 mm over the site: within the tolerance, not within the sigma
  const TargetFit scaled = FitTargets(spheres, targets, {});
  EXPECT_FALSE(scaled.usable);
  EXPECT_NE(scaled.message.find("scale"), std::string::npos) << scaled.message;
}

// What the fit brings into the places is as large as it says, in the middle of the targets and beyond them.
TEST(TargetFitTest, ItsCovarianceIsHonest) {
  for (const Vector3d& place : {Vector3d(3, 4, 1), Vector3d(25, -10, 1)}) {
    double normalized = 0.0;
    int fits = 0;
    for (std::uint32_t i = 0; i < 300; ++i) {
      const RandomStream random(8, 0, i);
      std::vector<KnownTarget> targets = Known(kCentres);
      std::uint64_t draw = 0;
      for (KnownTarget& target : targets) {
        for (double& axis : target.position_in_site) axis += target.sigma_m * random.Normal(draw++);
      }
      const TargetFit fit = FitTargets(kCentres, targets, {});
      if (!fit.usable) continue;  // of 300 some are beyond three sigmas of the scale
      ++fits;
      const Eigen::Vector2d truth = (SiteFromCloud() * place).head<2>();
      const Eigen::Vector2d error = (fit.site_from_cloud * place).head<2>() - truth;
      normalized += error.dot(fit.CovarianceAt(truth).inverse() * error);
    }
    EXPECT_GE(fits, 285);
    EXPECT_NEAR(std::sqrt(normalized / (2.0 * fits)), 1.0, 0.1) << place.transpose();
  }
}

// A square pillar of 0.5 m about (100, 200) and a round one of 0.6 m about (105, 200), points of 2 mm noise.
std::vector<Eigen::Vector2d> Slice() {
  const RandomStream random(6, 0, 0);
  CloudSlice slice({.from_elevation_m = 1.0, .to_elevation_m = 1.3});
  std::uint64_t draw = 0;
  for (int i = 0; i < 1600; ++i) {
    const auto [u, v] = random.Uniforms(draw++);
    const double along = u - 0.5, face = 0.25 + kNoise * random.Normal(draw++), z = 2.0 * v;
    const Eigen::Vector2d side = i % 2 == 0 ? Eigen::Vector2d(face, 0.5 * along) : Eigen::Vector2d(0.5 * along, face);
    const Eigen::Vector2d square = Eigen::Vector2d(100, 200) + (i % 4 < 2 ? 1.0 : -1.0) * side;
    slice.Add({square.x(), square.y(), z});
    const double angle = 2 * M_PI * u, radius = 0.3 + kNoise * random.Normal(draw++);
    slice.Add({105 + radius * std::cos(angle), 200 + radius * std::sin(angle), z});
  }
  return slice.Points();
}

TEST(ReferenceFeatureTest, CornersAndCentres) {
  const std::vector<Eigen::Vector2d> points = Slice();
  const auto locate = [&](FeatureKind kind, const Eigen::Vector2d& rough) {
    return LocateInReference(points, {.name = "F", .kind = kind, .position_in_site = rough}, {});
  };
  const MapFeature corner = locate(FeatureKind::kCorner, {100.27, 200.22});
  ASSERT_TRUE(corner.found) << corner.reason;
  EXPECT_LT((corner.position_in_site - Eigen::Vector2d(100.25, 200.25)).norm(), 0.001);
  EXPECT_LT(std::sqrt(corner.covariance.trace()), 0.001);
  const MapFeature square = locate(FeatureKind::kPillar, {100.05, 199.96});
  ASSERT_TRUE(square.found) << square.reason;
  EXPECT_LT((square.position_in_site - Eigen::Vector2d(100, 200)).norm(), 0.001);
  const MapFeature round = locate(FeatureKind::kPillar, {104.96, 200.03});
  ASSERT_TRUE(round.found) << round.reason;
  EXPECT_LT((round.position_in_site - Eigen::Vector2d(105, 200)).norm(), 0.001);
  EXPECT_FALSE(locate(FeatureKind::kCorner, {105, 200}).found);     // a round pillar has none
  EXPECT_FALSE(locate(FeatureKind::kCorner, {100, 200.25}).found);  // two corners are as near
  EXPECT_EQ(locate(FeatureKind::kCorner, {50, 50}).reason, "the reference has too few points near");
}

// Points every 10 mm on the first faces of a square of 0.5 m about the origin, turned.
std::vector<Eigen::Vector2d> FacesSeen(int num_faces, double turn, const RandomStream& random) {
  std::vector<Eigen::Vector2d> points;
  std::uint64_t draw = 0;
  for (int face = 0; face < num_faces; ++face) {
    const Eigen::Rotation2Dd rotation(turn + face * M_PI / 2);
    for (double along = -0.245; along < 0.25; along += 0.01)
      points.push_back(rotation * Eigen::Vector2d(0.25 + kNoise * random.Normal(draw++), along));
  }
  return points;
}

// Two fifths of a round pillar of 0.6 m.
std::vector<Eigen::Vector2d> ArcSeen(double turn, const RandomStream& random) {
  std::vector<Eigen::Vector2d> points;
  std::uint64_t draw = 0;
  for (double angle = turn; angle < turn + 0.45 * 2 * M_PI; angle += 0.033)
    points.push_back(Eigen::Rotation2Dd(angle) * Eigen::Vector2d(0.3 + kNoise * random.Normal(draw++), 0.0));
  return points;
}

TEST(ReferenceFeatureTest, SigmasAreHonest) {
  enum Scene { kCornerOfTwo, kThreeFaces, kFourFaces, kArc };
  for (const Scene scene : {kCornerOfTwo, kThreeFaces, kFourFaces, kArc}) {
    constexpr std::uint32_t kScans = 60;
    double normalized = 0.0;
    for (std::uint32_t i = 0; i < kScans; ++i) {
      const RandomStream random(10, scene, i);
      const double turn = 6.28 * random.Uniform(100000);
      const std::vector<Eigen::Vector2d> points =
          scene == kArc ? ArcSeen(turn, random) : FacesSeen(std::array{2, 3, 4}[scene], turn, random);
      NamedFeature wanted{.name = "F", .kind = scene == kCornerOfTwo ? FeatureKind::kCorner : FeatureKind::kPillar};
      if (scene == kCornerOfTwo) wanted.position_in_site = Eigen::Rotation2Dd(turn) * Eigen::Vector2d(0.25, 0.25);
      const MapFeature found = LocateInReference(points, wanted, {});
      ASSERT_TRUE(found.found) << scene << " " << i << ": " << found.reason;
      const Eigen::Vector2d error = found.position_in_site - wanted.position_in_site;
      EXPECT_LT(error.norm(), 0.005);
      normalized += error.dot(found.covariance.inverse() * error);
    }
    EXPECT_NEAR(std::sqrt(normalized / (2.0 * kScans)), 1.0, 0.2) << scene;
  }
}

TEST(ReferenceFeatureTest, TwoFacesAreNoPillar) {
  const RandomStream random(11, 0, 0);
  const auto reason = [&](const std::vector<Eigen::Vector2d>& points) {
    return LocateInReference(points, {.name = "F", .kind = FeatureKind::kPillar}, {}).reason;
  };
  EXPECT_EQ(reason(FacesSeen(2, 0.3, random)), "neither a circle nor three faces are seen");
  std::vector<Eigen::Vector2d> longer = FacesSeen(3, 0.0, random);  // no square: its sides are 0.7 m long
  for (double y : {-0.25, 0.25}) {
    for (double x = -0.25; x > -0.45; x -= 0.01) longer.emplace_back(x, y);
  }
  EXPECT_EQ(reason(longer), "neither a circle nor three faces are seen");
}

}  // namespace
}  // namespace survey
