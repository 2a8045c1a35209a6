// SPDX-License-Identifier: Apache-2.0
//
// What a mark that was left out looks like: exchanged labels, another point's label, mistyped coordinates, a wrong
// time. Sentences for people; a cause is a suggestion, the mark is left out either way.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "survey/graph/blunder_search.h"
#include "survey/graph/control_tests.h"

namespace survey {

// Where the others put a point that was left out.
struct PlaceByOthers {
  Eigen::Vector2d given = Eigen::Vector2d::Zero();       // in the site frame, m
  Eigen::Vector2d error = Eigen::Vector2d::Zero();       // given minus the place by the others
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of that difference

  Eigen::Vector2d Place() const { return given - error; }
  // That the point lies at `place` instead of the given coordinates.
  bool Fits(const Eigen::Vector2d& place) const;
};

// "easting 500123.456 looks mistyped: 500132.456 would fit to 0.003 m": two digits exchanged, one digit wrong, easting
// and northing exchanged.
std::optional<std::string> MistypedCoordinates(const PlaceByOthers& point);

// How far the marked place moved from the mark's scan to `seconds` later, in the site frame; empty beyond the track.
using MotionOfMark = std::function<std::optional<Eigen::Vector2d>(double seconds)>;

// "it would fit 0.5 s later".
std::optional<std::string> WrongTime(const PlaceByOthers& point, const MotionOfMark& motion);

struct SuspectMark {
  std::string point;  // as labelled
  PlaceByOthers place;
  MotionOfMark motion;
};

struct NamedPlace {
  std::string name;
  Eigen::Vector2d given = Eigen::Vector2d::Zero();
};

// One sentence for each suspect, in their order. `exchanged`: pairs of suspects; `points`: all control points.
std::vector<std::string> ExplainBlunders(const std::vector<SuspectMark>& suspects,
                                         const std::vector<std::pair<int, int>>& exchanged,
                                         const std::vector<NamedPlace>& points);

}  // namespace survey
