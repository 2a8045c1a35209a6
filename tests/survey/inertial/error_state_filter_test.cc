// SPDX-License-Identifier: Apache-2.0
//
// The filter against numerical derivatives, against its own covariance (Monte Carlo) and, smoothed, against a batch
// adjustment.
#include "survey/inertial/error_state_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>

#include "survey/inertial/smoother.h"
#include "survey/inertial/strapdown.h"
#include "survey/stats/philox.h"
#include "tests/support/inertial_truth.h"

namespace survey {
namespace {

using Eigen::Vector3d;

constexpr double kDt = 0.005;
constexpr Pose2 kBodyFromLidar{0.3, -0.1, 0.4};

Earth TestEarth() { return EarthAt(0.88, 100.0); }

// A tilted, turning, accelerating state.
InertialState SomeState() {
  return {{1.0, -2.0, 0.1},
          {0.8, 0.4, -0.05},
          FromRotationVector({0.10, -0.15, 0.7}),
          {0.001, -0.002, 0.003},
          {0.02, 0.01, -0.03}};
}

ImuIncrement SomeIncrement(int i) {
  const double t = 0.01 * i;
  return {kDt, kDt * Vector3d(0.2 * std::sin(t), -0.1, 0.6 + 0.1 * t),
          kDt * Vector3d(0.9 + std::cos(3 * t), 1.2 * std::sin(2 * t), 9.7)};
}

InertialState PropagatedTenTimes(const InertialState& start) {
  ErrorStateFilter filter(start, ErrorMatrix::Identity(), {}, TestEarth());
  for (int i = 0; i < 10; ++i) filter.Propagate(SomeIncrement(i));
  return filter.state();
}

TEST(ErrorStateFilterTest, TransitionIsTheDerivativeOfTheMechanization) {
  ErrorStateFilter filter(SomeState(), ErrorMatrix::Identity(), {}, TestEarth());
  for (int i = 0; i < 10; ++i) filter.Propagate(SomeIncrement(i));
  const ErrorMatrix analytic = ToMatrix(filter.PropagateCovariance());
  for (int column = 0; column < 15; ++column) {
    const ErrorVector step = 1e-5 * ErrorVector::Unit(column);
    const ErrorVector numeric =
        Minus(PropagatedTenTimes(Plus(SomeState(), step)), PropagatedTenTimes(Plus(SomeState(), ErrorVector(-step)))) /
        2e-5;
    for (int row = 0; row < 15; ++row) {
      // Left out: Coriolis on the velocity (1e-4 of dt) and the turn within a sample.
      EXPECT_NEAR(analytic(row, column), numeric(row), 2e-5 + 2e-3 * std::abs(numeric(row))) << row << "," << column;
    }
  }
}

// Central differences of an observation by the errors of the state.
template <int N>
void ExpectDesign(const Eigen::Matrix<double, N, 15>& analytic,
                  const std::function<Eigen::Matrix<double, N, 1>(const InertialState&)>& observe) {
  for (int column = 0; column < 15; ++column) {
    const ErrorVector step = 1e-6 * ErrorVector::Unit(column);
    const Eigen::Matrix<double, N, 1> numeric =
        (observe(Plus(SomeState(), step)) - observe(Plus(SomeState(), ErrorVector(-step)))) / 2e-6;
    EXPECT_LT((analytic.col(column) - numeric).norm(), 1e-8) << column;
  }
}

TEST(ErrorStateFilterTest, DesignsAreDerivatives) {
  ExpectDesign<3>(PlanarPoseDesign(SomeState(), kBodyFromLidar), [](const InertialState& state) {
    const Vector3d place = state.p_in_local + state.local_from_body * Vector3d(kBodyFromLidar.x, kBodyFromLidar.y, 0.0);
    return Vector3d(place.x(), place.y(), HeadingOf(state.local_from_body) + kBodyFromLidar.theta);
  });
  ExpectDesign<2>(BodyVelocityDesign(SomeState()), [](const InertialState& state) -> Eigen::Vector2d {
    return (state.local_from_body.conjugate() * state.v_in_local).head<2>();
  });
}

// ---- A drive with known truth and noise exactly as the filter believes
// -----------------------------------------------

struct Drive {
  static constexpr int kSteps = 300;     // of 0.1 s
  static constexpr int kSamples = 20;    // in a step
  std::vector<InertialState> truth;      // at the end of each step
  std::vector<ImuIncrement> increments;  // raw
  std::vector<Pose2> matches;            // of the lidar
  InertialState start;
  ErrorMatrix start_covariance;
};

const InertialNoise kNoise{};
const Eigen::Matrix3d kMatchCovariance = Vector3d(1e-4, 1e-4, 4e-6).asDiagonal();

// Figures of eight with a rocking platform, flat Earth that turns about the vertical.
test_support::Motion RockingEight(double t) {
  test_support::Motion motion;
  SetAttitude({0.03 * std::sin(0.9 * t), 0.02 * std::cos(1.3 * t), 0.8 * std::sin(0.4 * t)},
              {0.027 * std::cos(0.9 * t), -0.026 * std::sin(1.3 * t), 0.32 * std::cos(0.4 * t)}, &motion);
  motion.v = {1.1 * std::cos(0.5 * t), 0.9 * std::cos(0.8 * t + 0.3), 0.02 * std::sin(t)};
  motion.dv = {-0.55 * std::sin(0.5 * t), -0.72 * std::sin(0.8 * t + 0.3), 0.02 * std::cos(t)};
  return motion;
}

Vector3d Normals(const RandomStream& random, std::uint64_t index) {
  const auto [x, y] = random.Normals(2 * index);
  return {x, y, random.Normal(2 * index + 1)};
}

Drive Simulate(std::uint64_t seed) {
  const RandomStream random(seed, 77, 0);
  Drive drive;
  Earth earth = TestEarth();
  earth.rotation_in_nav.head<2>().setZero();
  earth.gravity_in_nav.head<2>().setZero();

  drive.start_covariance.setZero();
  drive.start_covariance.diagonal() << Vector3d::Constant(1e-4), Vector3d::Constant(1e-2), Vector3d::Constant(1e-4),
      Vector3d::Constant(1e-6), Vector3d::Constant(4e-4);
  InertialState truth;
  truth.v_in_local = RockingEight(0).v;
  truth.local_from_body = RockingEight(0).nav_from_body;
  ErrorVector error;
  for (int i = 0; i < 15; ++i)
    error(i) = std::sqrt(drive.start_covariance(i, i)) * random.Normal(static_cast<std::uint64_t>(i));
  truth.gyro_bias = error.segment<3>(9);
  truth.accelerometer_bias = error.segment<3>(12);
  drive.start = Plus(truth, ErrorVector(-error));

  std::uint64_t index = 1000;
  const double root = std::sqrt(kDt);
  for (int step = 0; step < Drive::kSteps; ++step) {
    for (int i = 0; i < Drive::kSamples; ++i) {
      const double t = (step * Drive::kSamples + i) * kDt;
      const auto middle = RockingEight(t + 0.5 * kDt);
      const Eigen::Quaterniond body_from_local = middle.nav_from_body.conjugate();
      const Vector3d force = middle.dv - earth.gravity_in_nav + 2.0 * earth.rotation_in_nav.cross(middle.v);
      // The true motion is what faultless increments of the middle lead to; noise and biases come on top.
      ErrorStateFilter mechanization(truth, ErrorMatrix::Zero(), kNoise, earth);
      const ImuIncrement now{kDt,
                             kDt * (middle.rate_in_body + body_from_local * earth.rotation_in_nav + truth.gyro_bias),
                             kDt * (body_from_local * force + truth.accelerometer_bias)};
      mechanization.Propagate(now);
      truth = mechanization.state();
      drive.increments.push_back({kDt, now.dtheta + root * kNoise.gyro_noise_rad_s_rthz * Normals(random, index),
                                  now.dvel + root * kNoise.accelerometer_noise_m_s2_rthz * Normals(random, index + 1)});
      truth.gyro_bias += root * kNoise.gyro_walk_rad_s2_rthz * Normals(random, index + 2);
      truth.accelerometer_bias += root * kNoise.accelerometer_walk_m_s3_rthz * Normals(random, index + 3);
      index += 4;
    }
    drive.truth.push_back(truth);
    const Vector3d noise = kMatchCovariance.diagonal().cwiseSqrt().cwiseProduct(Normals(random, index++));
    const Vector3d place = truth.p_in_local + truth.local_from_body * Vector3d(kBodyFromLidar.x, kBodyFromLidar.y, 0.0);
    drive.matches.push_back({place.x() + noise.x(), place.y() + noise.y(),
                             NormalizeAngle(HeadingOf(truth.local_from_body) + kBodyFromLidar.theta + noise.z())});
  }
  return drive;
}

FilterSteps Filter(const Drive& drive, const std::function<bool(int)>& matched) {
  Earth earth = TestEarth();
  earth.rotation_in_nav.head<2>().setZero();
  ErrorStateFilter filter(drive.start, drive.start_covariance, kNoise, earth);
  FilterSteps steps;
  for (int step = 0; step < Drive::kSteps; ++step) {
    for (int i = 0; i < Drive::kSamples; ++i)
      filter.Propagate(drive.increments[static_cast<std::size_t>(step * Drive::kSamples + i)]);
    const ErrorTransition transition = filter.PropagateCovariance();
    const InertialState predicted = filter.state();
    const PackedCovariance predicted_covariance(filter.covariance());
    if (matched(step)) {
      EXPECT_TRUE(
          filter.UpdatePlanarPose(drive.matches[static_cast<std::size_t>(step)], kMatchCovariance, kBodyFromLidar));
    }
    steps.push_back({step * 100'000'000LL, step > 0, transition, predicted, predicted_covariance, filter.state(),
                     PackedCovariance(filter.covariance())});
  }
  return steps;
}

double Nees(const InertialState& truth, const InertialState& state, const ErrorMatrix& covariance) {
  const ErrorVector error = Minus(truth, state);
  return error.dot(covariance.ldlt().solve(error));
}

TEST(ErrorStateFilterTest, ErrorsAreAsLargeAsTheFilterBelieves) {
  constexpr int kRuns = 60;
  double filtered = 0.0;
  double smoothed = 0.0;
  double filtered_square = 0.0;
  double smoothed_square = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const Drive drive = Simulate(static_cast<std::uint64_t>(run) + 1);
    const FilterSteps steps = Filter(drive, [](int) { return true; });
    filtered += Nees(drive.truth.back(), steps.back().updated, steps.back().updated_covariance.Full()) / kRuns;
    Smooth(steps, [&](std::size_t k, const InertialState& state, const ErrorMatrix& covariance) {
      if (k == steps.size() / 2) smoothed += Nees(drive.truth[k], state, covariance) / kRuns;
      if (k < 50 || k >= 250) return;
      const Vector3d before = drive.truth[k].p_in_local - steps[k].updated.p_in_local;
      filtered_square += before.head<2>().squaredNorm();
      smoothed_square += (drive.truth[k].p_in_local - state.p_in_local).head<2>().squaredNorm();
    });
  }
  // Mean of 60 chi-squares of 15 degrees: 15 +- 0.71.
  EXPECT_NEAR(filtered, 15.0, 2.5);
  EXPECT_NEAR(smoothed, 15.0, 2.5);
  std::printf("NEES filtered %.2f, smoothed %.2f (expected 15 +- 0.7); position rms ratio %.2f\n", filtered, smoothed,
              std::sqrt(smoothed_square / filtered_square));
  EXPECT_LT(smoothed_square, 0.7 * filtered_square);
}

TEST(ErrorStateFilterTest, SmoothingBridgesAStretchWithoutMatches) {
  double forward = 0.0;
  double bridged = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Drive drive = Simulate(seed);
    const FilterSteps steps = Filter(drive, [](int step) { return step < 150 || step >= 200; });
    Smooth(steps, [&](std::size_t k, const InertialState& state, const ErrorMatrix&) {
      if (k < 150 || k >= 200) return;
      forward += (drive.truth[k].p_in_local - steps[k].updated.p_in_local).head<2>().squaredNorm();
      bridged += (drive.truth[k].p_in_local - state.p_in_local).head<2>().squaredNorm();
    });
  }
  std::printf("5 s without matches: rms %.4f m forward, %.4f m smoothed\n", std::sqrt(forward / 1000),
              std::sqrt(bridged / 1000));
  EXPECT_LT(bridged, 0.1 * forward);
}

// The smoother is linear-Gaussian least squares in another order: all states of a short drive in one normal equation.
TEST(ErrorStateFilterTest, SmoothedEqualsTheBatchAdjustment) {
  constexpr int kStates = 12;
  const Drive drive = Simulate(5);
  FilterSteps steps = Filter(drive, [](int step) { return step % 3 == 0; });
  steps.erase(steps.begin() + kStates, steps.end());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(15 * kStates, 15 * kStates);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(15 * kStates);
  const ErrorMatrix prior = steps[0].updated_covariance.Full().inverse();
  normal.topLeftCorner<15, 15>() += prior;  // unknowns: errors of the updated states; the first has its own prior
  for (int k = 1; k < kStates; ++k) {
    const FilterStep& step = steps[static_cast<std::size_t>(k)];
    const FilterStep& before = steps[static_cast<std::size_t>(k - 1)];
    const ErrorMatrix phi = ToMatrix(step.transition);
    const ErrorMatrix weight =
        (step.predicted_covariance.Full() - phi * before.updated_covariance.Full() * phi.transpose()).inverse();
    // error(k) - phi error(k-1) = predicted - updated.
    Eigen::Matrix<double, 15, 30> design;
    design << -phi, ErrorMatrix::Identity();
    const ErrorVector residual = Minus(step.predicted, step.updated);
    normal.block<30, 30>(15 * (k - 1), 15 * (k - 1)) += design.transpose() * weight * design;
    right.segment<30>(15 * (k - 1)) += design.transpose() * weight * residual;
    if (k % 3 != 0) continue;
    const auto observed = PlanarPoseDesign(step.predicted, kBodyFromLidar);
    const Vector3d place =
        step.predicted.p_in_local + step.predicted.local_from_body * Vector3d(kBodyFromLidar.x, kBodyFromLidar.y, 0.0);
    const Pose2& match = drive.matches[static_cast<std::size_t>(k)];
    const Vector3d misfit(
        match.x - place.x(), match.y - place.y(),
        NormalizeAngle(match.theta - HeadingOf(step.predicted.local_from_body) - kBodyFromLidar.theta));
    const Vector3d left = misfit - observed * Minus(step.updated, step.predicted);
    normal.block<15, 15>(15 * k, 15 * k) += observed.transpose() * kMatchCovariance.inverse() * observed;
    right.segment<15>(15 * k) += observed.transpose() * kMatchCovariance.inverse() * left;
  }
  const Eigen::VectorXd errors = normal.ldlt().solve(right);
  const Eigen::MatrixXd inverse = normal.inverse();
  Smooth(steps, [&](std::size_t k, const InertialState& state, const ErrorMatrix& covariance) {
    const ErrorVector sigma = covariance.diagonal().cwiseSqrt();
    const ErrorVector batch = errors.segment<15>(15 * static_cast<Eigen::Index>(k));
    const ErrorVector difference = Minus(state, steps[k].updated) - batch;
    EXPECT_LT(difference.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.05) << k;
    const auto at = 15 * static_cast<Eigen::Index>(k);
    const ErrorVector batch_sigma = inverse.diagonal().segment<15>(at).cwiseSqrt();
    EXPECT_LT((batch_sigma.cwiseQuotient(sigma) - ErrorVector::Ones()).cwiseAbs().maxCoeff(), 0.01) << k;
  });
}

TEST(ErrorStateFilterTest, StandstillFindsTheGyroBiasAndRefusesMotion) {
  Earth earth = TestEarth();
  const double upright = earth.rotation_in_nav.z();
  ErrorMatrix covariance = ErrorMatrix::Zero();
  covariance.diagonal() << Vector3d::Constant(1e-4), Vector3d::Constant(1e-2), Vector3d::Constant(1e-4),
      Vector3d::Constant(1e-6), Vector3d::Constant(4e-4);
  ErrorStateFilter filter({}, covariance, kNoise, earth);
  const Vector3d bias(0.0005, -0.0008, 0.001);
  const Vector3d rate = bias + Vector3d(0, 0, upright);
  const Vector3d force = -earth.gravity_in_nav;
  for (int step = 0; step < 100; ++step) {
    for (int i = 0; i < 20; ++i) filter.Propagate({kDt, kDt * rate, kDt * force});
    filter.PropagateCovariance();
    EXPECT_TRUE(filter.UpdateStandstill(0.01, rate, 0.1));
  }
  EXPECT_LT((filter.state().gyro_bias - bias).norm(), 1.2e-4);  // the prior still counts
  EXPECT_LT(filter.state().v_in_local.norm(), 1e-3);
  const InertialState before = filter.state();
  EXPECT_FALSE(filter.UpdateStandstill(0.01, rate + Vector3d(0, 0, 0.5), 0.1));
  EXPECT_FALSE(filter.UpdateBodyVelocity({1.0, 0.0}, 0.05));
  EXPECT_FALSE(filter.UpdatePlanarPose({5.0, 0.0, 0.0}, kMatchCovariance, {}));
  EXPECT_EQ(Minus(filter.state(), before).norm(), 0.0);
}

}  // namespace
}  // namespace survey
