// SPDX-License-Identifier: Apache-2.0
//
// The particle filter: its parts against hand-computed and sampled values, the whole on two laps of a ring.
#include "survey/particles/particle_filter.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "survey/geometry/rigid_fit.h"
#include "survey/graph/block_adjustment.h"
#include "survey/particles/filtered_track.h"
#include "survey/particles/weights.h"
#include "survey/stats/philox.h"
#include "tests/support/room.h"

namespace survey {
namespace {

std::vector<double> Logs(std::vector<double> weights) {
  for (double& weight : weights) weight = std::log(weight);
  return weights;
}

TEST(Weights, EffectiveSampleSizeOfHandComputedWeights) {
  std::vector<double> weights = Logs({1.0, 2.0, 1.0});
  ASSERT_TRUE(NormalizeLogWeights(&weights));
  EXPECT_NEAR(std::exp(weights[1]), 0.5, 1e-12);
  EXPECT_NEAR(EffectiveSampleSize(weights), 1.0 / (0.0625 + 0.25 + 0.0625), 1e-12);
}

TEST(Weights, TinyWeightsKeepTheirRatio) {
  std::vector<double> weights = {-5000.0, -5000.0 + std::log(3.0)};
  ASSERT_TRUE(NormalizeLogWeights(&weights));
  EXPECT_NEAR(std::exp(weights[1]), 0.75, 1e-9);
}

TEST(Weights, WithoutAnyWeightAllAreEqualAndItIsTold) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  std::vector<double> weights = {kNone, std::nan(""), kNone, kNone};
  EXPECT_FALSE(NormalizeLogWeights(&weights));
  EXPECT_NEAR(EffectiveSampleSize(weights), 4.0, 1e-12);
}

TEST(Weights, SystematicResamplingTakesEachByItsShare) {
  const std::vector<double> weights = Logs({0.5, 0.1, 0.0, 0.4});
  EXPECT_EQ(SystematicResampling(weights, 0.2), (std::vector<int>{0, 0, 1, 3}));  // teeth at 0.05 0.30 0.55 0.80
  EXPECT_EQ(SystematicResampling(weights, 0.9), (std::vector<int>{0, 0, 3, 3}));  // 0.225 0.475 0.725 0.975
}

TEST(SamplePose, HasTheCovarianceThatWasAskedFor) {
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.0025;
  const RandomStream stream(3, 1, 2);
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  constexpr int kSamples = 20000;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const auto [a, b] = stream.Normals(2 * i);
    const Pose2 pose = SamplePose({1.0, 2.0, 0.5}, covariance, {a, b, stream.Normal(2 * i + 1)});
    const Eigen::Vector3d d = pose.Vector() - Eigen::Vector3d(1.0, 2.0, 0.5);
    squares += d * d.transpose() / kSamples;
  }
  const Eigen::Vector3d sigma = covariance.diagonal().cwiseSqrt();
  EXPECT_LT((squares - covariance).cwiseQuotient(sigma * sigma.transpose()).cwiseAbs().maxCoeff(), 0.04);
}

TEST(SurfaceMap, ACopyDrawsWithoutChangingTheOriginal) {
  const std::vector<SurfacePoint> wall = {{{1.0F, 0.5F}, {-1.0F, 0.0F}}, {{1.0F, 7.0F}, {-1.0F, 0.0F}}};
  const std::vector<SurfacePoint> beside = {{{1.04F, 0.52F}, {-1.0F, 0.0F}}};
  SurfaceMap original(0.1);
  original.Insert({}, wall);
  SurfaceMap copy = original;
  const Surfel* shared = original.Nearest({1.0F, 7.0F}, {-1.0F, 0.0F});
  copy.Insert({}, beside);
  EXPECT_EQ(original.Nearest({1.0F, 0.5F}, {-1.0F, 0.0F})->count, 1.0F);
  EXPECT_EQ(copy.Nearest({1.0F, 0.5F}, {-1.0F, 0.0F})->count, 2.0F);
  EXPECT_EQ(copy.Nearest({1.0F, 7.0F}, {-1.0F, 0.0F}), shared);  // another tile, still common
}

double RmsAfterRigidFit(const Track& track, const std::vector<Pose2>& truth) {
  std::vector<Eigen::Vector2d> a;
  std::vector<Eigen::Vector2d> b;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    a.push_back(track.scans[i].local_from_scan.Translation());
    b.push_back(truth[i].Translation());
  }
  return FitRigid(a, b)->rms_m;
}

// The matcher's track with a fault that it did not notice: behind `scan` everything is turned and shifted.
Track Broken(const Track& track, std::size_t scan, const Pose2& fault) {
  Track broken = track;
  const Pose2 at = track.scans[scan].local_from_scan;
  const Pose2 shift = at * fault * Inverse(at);
  for (std::size_t i = scan; i < track.scans.size(); ++i)
    broken.scans[i].local_from_scan = shift * track.scans[i].local_from_scan;
  return broken;
}

struct RingWalk : public testing::Test {
  static void SetUpTestSuite() {
    truth = new std::vector<Pose2>(test_support::LapsOfTheRing(2));
    session = new Session(test_support::SimulateSession(test_support::Ring(), *truth, 10.0, 0.01, 1.03, 0.01));
    local = new Track(TrackBlock(*session, {}));
  }
  static TrajectoryTree Run(const Track& track, const Answers& answers, int particles = 20) {
    ParticleFilterOptions options;
    options.particles = particles;
    return RunParticleFilter(*session, track, answers, {}, options);
  }
  // True, but for the operator's error.
  static Answer Correct(int scan, int reference) {
    Answer answer{.name = "a.json", .scan = {scan}, .decision = Decision::kCorrect, .reference = {reference}};
    answer.reference_from_scan =
        Between((*truth)[static_cast<std::size_t>(reference)], (*truth)[static_cast<std::size_t>(scan)]) *
        Pose2{0.04, -0.03, 0.01};
    return answer;
  }
  static const std::vector<Pose2>* truth;
  static const Session* session;
  static const Track* local;
};
const std::vector<Pose2>* RingWalk::truth = nullptr;
const Session* RingWalk::session = nullptr;
const Track* RingWalk::local = nullptr;

TEST_F(RingWalk, FilterClosesTheSecondLap) {
  const Track track = FollowBestTrajectory(*session, *local, Run(*local, {}));
  EXPECT_LT(RmsAfterRigidFit(track, *truth), 0.05);
  ASSERT_EQ(track.submaps.size(), local->submaps.size());
  for (const SubmapConstraint& constraint : track.constraints) {
    const Pose2 pose = track.submaps[static_cast<std::size_t>(constraint.submap.value)].local_from_submap *
                       constraint.submap_from_scan;
    const Pose2& scan = track.scans[static_cast<std::size_t>(constraint.scan.value)].local_from_scan;
    ASSERT_LT((pose.Translation() - scan.Translation()).norm(), 1e-9);
  }
}

std::vector<double> Numbers(const TrajectoryTree& tree) {
  std::vector<double> numbers;
  for (const FilterUpdate& update : tree) {
    for (const Pose2& pose : update.poses) numbers.insert(numbers.end(), {pose.x, pose.y, pose.theta});
    numbers.insert(numbers.end(), update.log_weights.begin(), update.log_weights.end());
    numbers.insert(numbers.end(), update.parents.begin(), update.parents.end());
  }
  return numbers;
}

TEST_F(RingWalk, ThreadsDoNotChangeAByte) {
  const auto run = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return Numbers(Run(*local, {}, 8));
  };
  EXPECT_EQ(run(1), run(4));
}

TEST_F(RingWalk, ARunResumedFromAChangedAnswerIsTheFullRun) {
  const int lap = static_cast<int>(truth->size()) / 2;
  const Answers before = {Correct(lap + 100, 100), Correct(lap + 250, 250)};
  Answers after = before;
  after[1].sigma.x() = 0.05;
  ParticleFilterOptions options;
  options.particles = 8;
  // Nothing before the answered scan depends on the answer but the update at its reference, which both have.
  TrajectoryTree known = Run(*local, before, 8);
  std::erase_if(known, [&](const FilterUpdate& update) { return update.scan.value >= lap + 250; });
  const TrajectoryTree resumed = RunParticleFilter(*session, *local, after, {}, options, {}, known);
  EXPECT_EQ(Numbers(resumed), Numbers(Run(*local, after, 8)));
  EXPECT_NE(Numbers(resumed), Numbers(Run(*local, before, 8)));
}

TEST_F(RingWalk, AnAnswerBringsTheParticlesBackInTheFilterAndRepairsThePastInTheGraph) {
  const int fault = static_cast<int>(truth->size()) * 6 / 10;
  const int answered = fault + 120;
  const Track broken = Broken(*local, static_cast<std::size_t>(fault), {1.5, -0.9, 0.25});
  const Answers answers = {Correct(answered, answered - static_cast<int>(truth->size()) / 2)};
  const auto end_error = [&](const Track& track) {
    const Pose2 motion = Between(track.scans.front().local_from_scan, track.scans.back().local_from_scan);
    return (motion.Translation() - Between(truth->front(), truth->back()).Translation()).norm();
  };
  EXPECT_GT(end_error(FollowBestTrajectory(*session, broken, Run(broken, {}))), 1.0);
  EXPECT_LT(end_error(FollowBestTrajectory(*session, broken, Run(broken, answers))), 0.3);
}

TEST_F(RingWalk, AConfirmedPoseIsKeptByTheParticlesThatHaveIt) {
  const TrajectoryTree before = Run(*local, {}, 8);
  const auto update = std::find_if(before.begin() + 40, before.end(), [](const auto& each) { return !each.resampled; });
  const auto k = static_cast<std::size_t>(update - before.begin());
  const auto apart = [](const Pose2& a, const Pose2& b) { return (a.Translation() - b.Translation()).norm(); };
  const auto other = std::max_element(update->poses.begin(), update->poses.end(), [&](const auto& a, const auto& b) {
    return apart(a, update->poses[0]) < apart(b, update->poses[0]);
  });
  const auto particle = static_cast<std::size_t>(other - update->poses.begin());
  Answer confirmed{.name = "a.json", .scan = update->scan, .decision = Decision::kConfirm, .reference = {0}};
  confirmed.reference_from_scan = Between(PoseOfAncestor({before.begin(), update + 1}, particle, 0), *other);
  confirmed.sigma = Eigen::Vector3d(0.1, 0.1, 0.1) * apart(*other, update->poses[0]);
  const TrajectoryTree after = Run(*local, {confirmed}, 8);
  EXPECT_TRUE(after[k].resampled);
  for (const Pose2& pose : after[k].poses) EXPECT_LT(apart(pose, *other), 0.7 * apart(update->poses[0], *other));
}

TEST_F(RingWalk, TheGraphNamesAGrosslyWrongAnswerAndOnlyThat) {
  const int lap = static_cast<int>(truth->size()) / 2;
  Answers answers;
  for (int i = 1; i <= 5; ++i) answers.push_back(Correct(lap + 40 * i, 40 * i));
  answers[2].reference_from_scan.x += 1.5;
  std::vector<StampNs> stamps;
  for (const Scan& scan : session->scans) stamps.push_back(scan.stamp_ns);
  const BlockAdjustment adjusted = AdjustBlock(*local, {}, {}, stamps, {}, answers);
  ASSERT_TRUE(adjusted.usable) << adjusted.message;
  ASSERT_EQ(adjusted.answers.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(adjusted.answers[i].in_conflict, i == 2) << i;
}

TEST_F(RingWalk, ARejectedStretchLetsTheGraphTakeTheFaultThere) {
  const int fault = static_cast<int>(truth->size()) * 6 / 10;
  const int answered = fault + 120;
  Track broken = Broken(*local, static_cast<std::size_t>(fault), {0.6, -0.3, 0.1});
  for (SubmapConstraint& constraint : broken.constraints)
    constraint.submap_from_scan =
        Between(broken.submaps[static_cast<std::size_t>(constraint.submap.value)].local_from_submap,
                broken.scans[static_cast<std::size_t>(constraint.scan.value)].local_from_scan);
  std::vector<StampNs> stamps;
  for (const Scan& scan : session->scans) stamps.push_back(scan.stamp_ns);
  Answers answers = {Correct(answered, answered - static_cast<int>(truth->size()) / 2)};
  const auto rms = [&] {
    const BlockAdjustment adjusted = AdjustBlock(broken, {}, {}, stamps, {}, answers);
    Track moved = broken;
    for (std::size_t i = 0; i < moved.scans.size(); ++i)
      moved.scans[i].local_from_scan = adjusted.solution.scans[i].site_from_scan;
    return RmsAfterRigidFit(moved, *truth);
  };
  const double spread_out = rms();
  answers.insert(answers.begin(),
                 {.name = "b.json", .scan = {fault - 2}, .decision = Decision::kRejectStretch, .end = {fault + 2}});
  EXPECT_LT(rms(), 0.5 * spread_out);
  EXPECT_LT(rms(), 0.2);
}

}  // namespace
}  // namespace survey
