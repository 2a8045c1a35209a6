// SPDX-License-Identifier: Apache-2.0
//
// A start for the pose graph that needs none itself, [Carlone15]: the relative headings first, as a linear problem in
// (cos, sin) whose unit length is dropped and restored afterwards (chordal relaxation), then the positions, which are
// linear once headings are known. Near the optimum for graphs of moderate noise, however far off the poses were.
#pragma once

#include <optional>

#include "survey/graph/pose_graph.h"

namespace survey {

// The graph's poses from its edges alone, with the held pose where it is; marked points without coordinates follow as
// the means of their marks. Empty when no pose is held or the edges do not tie all poses together.
std::optional<PoseGraph> ChordalStart(const PoseGraph& graph);

}  // namespace survey
