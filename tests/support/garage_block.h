// SPDX-License-Identifier: Apache-2.0
//
// A simulated block like those of a parking garage, as a graph: two laps of three aisles with honest, independent
// errors of motions, loops, marks and control coordinates (correlated, as a network leaves them). Truth is known.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "survey/graph/block_graph.h"
#include "survey/graph/control_tie.h"

namespace test_support {

struct GarageBlock {
  survey::BlockGraph block;  // local frame
  survey::ControlNetwork control;
  std::vector<survey::Pose2> site_from_pose;  // truth
  survey::NetworkFactors factors;             // that the free solution applied

  std::size_t num_marks() const { return block.graph.marks.size(); }
  survey::ControlPoint& PointOfMark(std::size_t mark);
};

inline constexpr double kGarageSpeed_m_s = 0.8;

// `motion_errors`: of the motions, in their sigmas.
GarageBlock SimulateGarageBlock(std::uint32_t seed, double motion_errors = 1.0);

// Free solution, then tests and constrained solution, as `adjust` does it. `garage` gets the solved poses. The free one
// serves for any control: the marks, each on a point of its own, are no part of it.
void SolveGarageBlockFree(GarageBlock* garage);
survey::ControlTie TieGarageBlock(GarageBlock* garage);
survey::ControlTie AdjustGarageBlock(GarageBlock* garage);

// What the adjustment of seeded blocks found, clean ones and ones with a planted error.
struct ReliabilityCounts {
  int runs = 0;
  int marks_tested = 0;
  int false_alarms = 0;    // T beyond the critical value of 0.001 on a good mark
  int clean_rejected = 0;  // runs without blunder that lost a mark
  int ellipses = 0;
  int inside = 0;           // true place within the 95 % ellipse
  int blunders_named = 0;   // 3 x MDB in a point, any direction: this mark and no other is left out
  int exchanges_named = 0;  // two labels exchanged: both marks are left out, and their sentence names both
  int exchanges_alone = 0;  // and no other mark is left out
  int times_found = 0;      // a mark 0.5 s off: left out
  int times_named = 0;      // and the sentence says so, to 0.1 s
  // Blocks without loops whose sigmas are ten times too large.
  int unlooped_rejected = 0;  // that lost a mark
  int unlooped_inside = 0;    // true places within the 95 % ellipse, of as many as above
  double unlooped_squared_error = 0.0;
  double unlooped_variance = 0.0;  // as predicted
};

ReliabilityCounts CountReliability(std::uint32_t first_seed, int runs);

}  // namespace test_support
