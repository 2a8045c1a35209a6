// SPDX-License-Identifier: Apache-2.0
#include "survey/submaps/motion_predictor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "survey/stats/philox.h"

namespace survey {
namespace {

constexpr StampNs kStep_ns = 100'000'000;

// A platform that winds along at 1 m/s, sampled at 10 Hz.
Pose2 TruthAt(double t_s) {
  Pose2 pose;
  for (double t = 0.0; t < t_s - 1e-9; t += 0.01) {
    const double heading = 0.8 * std::sin(0.9 * t);
    pose.x += 0.01 * std::cos(heading);
    pose.y += 0.01 * std::sin(heading);
  }
  pose.theta = 0.8 * std::sin(0.9 * t_s);
  return pose;
}

// Odometry stamped t shows the motion at t + lead.
Session Winding(double lead_s, double noise_rad, int scans) {
  Session session;
  for (int i = -20; i < scans + 20; ++i) {
    OdometrySample sample{i * kStep_ns, TruthAt(std::max(0.0, 0.1 * i + lead_s))};
    if (noise_rad > 0.0)
      sample.odom_from_body.theta += noise_rad * RandomStream(3, 1, static_cast<std::uint64_t>(i + 20)).Normal(0);
    session.odometry.push_back(sample);
  }
  return session;
}

// Root mean square error of the predicted heading and position over the last half of the walk, true poses as matches.
struct Errors {
  double m = 0.0;
  double rad = 0.0;
};
Errors PredictionErrors(int scans, MotionPredictor* predictor) {
  Errors sum;
  for (int i = 0; i < scans; ++i) {
    const Pose2 truth = TruthAt(0.1 * i);
    const PredictedPose predicted = predictor->Predict(i * kStep_ns);
    const Pose2 error = Between(truth, predicted.local_from_scan);
    if (i >= scans / 2) {
      sum.m += error.Translation().squaredNorm();
      sum.rad += error.theta * error.theta;
    }
    predictor->Update(i * kStep_ns, truth, Eigen::Matrix3d::Zero(), true);
  }
  const double n = scans - scans / 2;
  return {std::sqrt(sum.m / n), std::sqrt(sum.rad / n)};
}

TEST(MotionPredictor, FindsThatTheOdometryLeadsTheLaser) {
  for (const double lead : {-0.3, 0.0, 0.1, 0.25, 0.6}) {
    const Session session = Winding(lead, 0.0, 300);
    MotionPredictor predictor(session, {});
    const Errors errors = PredictionErrors(300, &predictor);
    EXPECT_NEAR(predictor.odometry_lead_s(), lead, 0.051) << lead;
    EXPECT_LT(errors.rad, 0.007) << lead;
  }
}

TEST(MotionPredictor, GivesUpWheelsThatAreWorseThanConstantVelocity) {
  const Session session = Winding(0.0, 0.05, 300);
  MotionPredictor noisy(session, {});
  const Session none;
  MotionPredictor blind(none, {});
  const double blind_rad = PredictionErrors(300, &blind).rad;
  EXPECT_LT(PredictionErrors(300, &noisy).rad, 1.2 * blind_rad);
  EXPECT_GT(blind_rad, 0.003);  // what good wheels make better
  const Session good_session = Winding(0.0, 0.0, 300);
  MotionPredictor good(good_session, {});
  EXPECT_LT(PredictionErrors(300, &good).rad, 0.5 * blind_rad);
}

TEST(MotionPredictor, ConstantVelocityTakesOverInAGapOfTheOdometry) {
  Session session = Winding(0.0, 0.0, 100);
  std::erase_if(session.odometry,
                [](const OdometrySample& s) { return s.stamp_ns > 4'000'000'000 && s.stamp_ns < 7'000'000'000; });
  MotionPredictor predictor(session, {});
  for (int i = 0; i < 100; ++i) {
    const PredictedPose predicted = predictor.Predict(i * kStep_ns);
    if (i == 55) {
      EXPECT_EQ(predicted.source, Prediction::kConstantVelocity);
    }
    if (i == 30 || i == 90) {
      EXPECT_EQ(predicted.source, Prediction::kOdometry);
    }
    predictor.Update(i * kStep_ns, TruthAt(0.1 * i), Eigen::Matrix3d::Zero(), true);
  }
}

}  // namespace
}  // namespace survey
