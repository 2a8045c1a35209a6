// SPDX-License-Identifier: Apache-2.0
//
// What a person says about one scan, in answer to a review request or unasked: an observation at a scan, not the reply
// to an event, so it counts whether or not the request comes up again. [AS] section IV-A.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/submaps/track.h"
#include "survey/submaps/wall_relation.h"

namespace survey {

enum class Decision {
  kConfirm,        // the estimate is right: a weak observation
  kCorrect,        // the pose is this one
  kPick,           // the same, chosen among the alternatives of the request
  kRelate,         // how a wall of the scan lies to a wall of the reference
  kRejectStretch,  // the scan matches from this scan to `end` are wrong
  kSkip            // seen, not decided
};

constexpr std::string_view Name(Decision decision) {
  switch (decision) {
    case Decision::kConfirm:
      return "confirm";
    case Decision::kCorrect:
      return "correct";
    case Decision::kPick:
      return "pick";
    case Decision::kRelate:
      return "relate";
    case Decision::kRejectStretch:
      return "reject_stretch";
    case Decision::kSkip:
      return "skip";
  }
  return "";
}

struct Answer {
  std::string name;  // of its file, for messages
  ScanId scan;
  Decision decision = Decision::kSkip;
  ScanId reference;  // an earlier scan, in whose frame the pose is given: true in every particle's own map
  Pose2 reference_from_scan;
  Eigen::Vector3d sigma = {0.1, 0.1, 0.08};   // m, m, rad, in the frame of the reference
  ScanId end;                                 // of a rejected stretch, its last scan
  std::optional<Pose2> site_from_scan;        // instead of the pose in the reference; sigma east, north, heading
  std::optional<WallPair> walls;              // of kRelate: base is the reference, target the scan
  Eigen::Vector2d wall_sigma = {0.05, 0.02};  // m, rad

  bool HasPose() const {
    return decision == Decision::kCorrect || decision == Decision::kPick || decision == Decision::kConfirm;
  }
  bool HasRelativePose() const { return HasPose() && !site_from_scan; }
  bool MovesParticles() const { return HasRelativePose() && decision != Decision::kConfirm; }
  bool ActsInFilter() const { return HasRelativePose() || walls; }
  bool ActsInLocalFrame() const { return HasRelativePose() || walls || decision == Decision::kRejectStretch; }
};

// In order of their scans, one for each at most.
using Answers = std::vector<Answer>;

}  // namespace survey
