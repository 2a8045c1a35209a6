// SPDX-License-Identifier: Apache-2.0
#include "survey/planning/control_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "survey/graph/control_tie.h"
#include "survey/graph/variance_components.h"
#include "tests/support/garage_block.h"

namespace survey {
namespace {

using test_support::GarageBlock;
using test_support::SimulateGarageBlock;

constexpr ControlPlanOptions kOptions{.control_sigma_m = 0.003605551, .mark_sigma_m = 0.005, .max_points = 12};

// Mean of the squared errors of the way over seeds, with control at some of the marks only.
double ActualRms(const std::vector<std::size_t>& marks, int seeds) {
  double squares = 0.0;
  int count = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    GarageBlock garage = SimulateGarageBlock(static_cast<std::uint32_t>(5000 + seed));
    for (std::size_t mark = 0; mark < garage.num_marks(); ++mark) {
      if (std::find(marks.begin(), marks.end(), mark) == marks.end()) garage.PointOfMark(mark).role = PointRole::kTie;
    }
    const ControlTie tie = test_support::AdjustGarageBlock(&garage);
    for (std::size_t i = 0; i < garage.site_from_pose.size(); i += 2) {
      squares += (garage.block.graph.poses[i].Translation() + tie.offset - garage.site_from_pose[i].Translation())
                     .squaredNorm();
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST(ControlPlan, PredictedSigmaAgreesWithTheActualError) {
  const std::vector<std::size_t> marks = {0, 3, 6, 9};
  const GarageBlock garage = SimulateGarageBlock(5000);
  std::vector<int> taken;
  for (const std::size_t mark : marks) taken.push_back(garage.block.graph.marks[mark].pose);
  const auto plan = PlanControl(garage.block.graph, 0, taken, kOptions);
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->steps.size(), 12U);
  EXPECT_EQ(plan->steps[2].pose, taken[2]);
  const double actual = ActualRms(marks, 25);
  EXPECT_NEAR(plan->steps[3].rms, actual, 0.25 * actual);
}

// [CN] table 2: the gain from 4 to 8 points is large, from 8 to 12 small.
TEST(ControlPlan, EachPointHelpsLessThanTheOneBefore) {
  const GarageBlock garage = SimulateGarageBlock(1);
  const auto plan = PlanControl(garage.block.graph, 0, {}, kOptions);
  ASSERT_TRUE(plan);
  for (std::size_t i = 2; i < plan->steps.size(); ++i) EXPECT_LT(plan->steps[i].rms, plan->steps[i - 1].rms);
  EXPECT_GT(plan->steps[3].rms - plan->steps[7].rms, 1.5 * (plan->steps[7].rms - plan->steps[11].rms));
  EXPECT_GE(plan->steps[11].max, plan->steps[11].rms);
  // The first two span the block.
  EXPECT_GT((plan->steps[0].place - plan->steps[1].place).norm(), 25.0);
}

TEST(ControlPlan, ThePlacesChosenBeatEvenOnes) {
  const GarageBlock garage = SimulateGarageBlock(2);
  const auto best = PlanControl(garage.block.graph, 0, {}, kOptions);
  const auto first_ones = PlanControl(garage.block.graph, 0, {0, 10, 20, 30}, kOptions);
  ASSERT_TRUE(best && first_ones);
  EXPECT_LT(best->steps[3].rms, first_ones->steps[3].rms);
}

}  // namespace
}  // namespace survey
