// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/delivery.h"

#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/delivery_csv.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace {

using survey::Delivery;
using survey::PointFate;
using survey::PointRole;

const Delivery kBefore = {.points = {{"1", PointRole::kControl, {0, 0}},
                                     {"2", PointRole::kControl, {20, 0}},
                                     {"3", PointRole::kCheck, {40, 0}},
                                     {"4", PointRole::kControl, {60, 0}}},
                          .poses = {{"A", 1, {1, 0}}, {"A", 2, {18, 0}}, {"B", 1, {21, 0}}, {"C", 1, {90, 0}}}};

Delivery Now() {
  Delivery now = kBefore;
  now.points[0].position.x() += 0.00005;  // less than is told
  now.points[1].position.y() += 0.03;
  now.points[2].role = PointRole::kControl;
  now.points[3].name = "5";
  now.poses = {{"A", 1, {1, 0}}, {"A", 2, {18, 0.01}}, {"B", 1, {21, 0.02}}, {"B", 9, {99, 9}}, {"D", 1, {0, 0}}};
  return now;
}

TEST(DeliveryTest, TellsWhatBecameOfEachPoint) {
  const survey::DeliveryChanges changes = survey::CompareDeliveries(kBefore, Now());
  ASSERT_EQ(changes.control.size(), 4);
  EXPECT_EQ(changes.control[0].name, "2");
  EXPECT_EQ(changes.control[0].fate, PointFate::kMoved);
  EXPECT_TRUE(changes.control[0].shift.isApprox(Eigen::Vector2d(0, 0.03)));
  ASSERT_TRUE(changes.control[0].map_shift.has_value());
  EXPECT_NEAR(changes.control[0].map_shift->y(), 0.02, 1e-12);  // block B, which moved more than A
  EXPECT_EQ(changes.control[1].fate, PointFate::kOtherRole);
  EXPECT_FALSE(changes.control[1].map_shift.has_value());
  EXPECT_EQ(changes.control[2].fate, PointFate::kRemoved);
  EXPECT_EQ(changes.control[3].fate, PointFate::kAdded);
}

TEST(DeliveryTest, TellsHowFarTheBlocksMoved) {
  const auto blocks = survey::CompareDeliveries(kBefore, Now()).blocks;
  ASSERT_EQ(blocks.size(), 4);
  EXPECT_EQ(blocks[0].num_poses, 2);
  EXPECT_NEAR(blocks[0].mean_shift.y(), 0.005, 1e-12);
  EXPECT_NEAR(blocks[0].rms_shift, 0.01 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(blocks[0].max_shift, 0.01, 1e-12);
  EXPECT_EQ(blocks[0].place_of_max, Eigen::Vector2d(18, 0.01));
  EXPECT_EQ(blocks[2].num_poses, 0);  // C is gone
  EXPECT_EQ(blocks[3].num_poses, 0);  // D is new
}

TEST(DeliveryTest, FilesReadBackAndRefuseMistakes) {
  const test_support::ScratchFolder scratch;
  formats::WriteDeliveredControl(scratch / "control.csv", kBefore.points);
  formats::WriteDeliveredPoses(scratch / "poses.csv", kBefore.poses);
  const Delivery read{formats::ReadDeliveredControl(scratch / "control.csv"),
                      formats::ReadDeliveredPoses(scratch / "poses.csv")};
  EXPECT_TRUE(survey::CompareDeliveries(kBefore, read).control.empty());
  EXPECT_EQ(read.poses.at(3).stamp_ns, 1);
  for (const char* rows : {"1,control,0,0\n1,control,1,1\n", "1,tie,0,0\n", "1,control,0,north\n", "1,control,0\n"}) {
    formats::WriteFileAtomically(scratch / "control.csv", "point,role,easting,northing\n" + std::string(rows));
    EXPECT_THROW(formats::ReadDeliveredControl(scratch / "control.csv"), formats::DataError) << rows;
  }
}

}  // namespace
