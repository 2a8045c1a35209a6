// SPDX-License-Identifier: Apache-2.0
//
// "What the map shows here lies there" ([AS] section IV-B, adjusting the map): an observation of a person in the
// adjustment of a block, not a shift of its raster. It is tested like a mark on a control point and left out where it
// contradicts control: its sigma is never below that of control, so that a person does not outweigh a surveyor.
#pragma once

#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/edits/map_edit.h"
#include "survey/graph/controlled_graph.h"
#include "survey/graph/solution.h"
#include "survey/submaps/track.h"

namespace survey {

struct MapArrow {
  std::string name;  // uid of the edit, numbered where it has several
  EditAnchor tail;   // in the scan that drew it
  Eigen::Vector2d head_in_site = Eigen::Vector2d::Zero();
  double sigma_m = 0.05;  // per axis
};

inline constexpr double kLeastArrowSigma_m = 0.05;

// Adds each arrow as a mark of the nearest node and a control point of its own, "arrow NAME". Returns the names of
// those whose scan is gone. `stamps`: of the track's scans.
std::vector<std::string> AddArrows(const std::vector<MapArrow>& arrows, const std::vector<StampNs>& stamps,
                                   Track* track, ControlNetwork* control);

// For the joint adjustment of a site, whose network does not know them: arrows that took part are no control of the
// block but keep their heads in its graph, and the marks of all arrows move behind the others, as TakeArrows takes them
// out of the solution. `solution`: with the arrows.
void KeepArrows(const std::vector<MapArrow>& arrows, const Solution& solution, ControlledGraph* graph);

// Takes them out of the solution again, for they are no control: returns them with their residuals and tests.
std::vector<SolvedMark> TakeArrows(const std::vector<MapArrow>& arrows, Solution* solution);

// Whether control alone fixes the block: marks on two control points.
bool IsTiedByControl(const Track& track, const ControlNetwork& control);

}  // namespace survey
