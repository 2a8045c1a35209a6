// SPDX-License-Identifier: Apache-2.0
//
// What a person says about one scan, in answer to a review request or unasked: an observation at a scan, not the reply
// to an event, so it counts whether or not the request comes up again. [AS] section IV-A.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "survey/geometry/pose2.h"
#include "survey/submaps/track.h"

namespace survey {

enum class Decision {
  kConfirm,        // the estimate is right: a weak observation
  kCorrect,        // the pose is this one
  kPick,           // the same, chosen among the alternatives of the request
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
  Eigen::Vector3d sigma = {0.1, 0.1, 0.08};  // m, m, rad, in the frame of the reference
  ScanId end;                                // of a rejected stretch, its last scan

  bool HasPose() const {
    return decision == Decision::kCorrect || decision == Decision::kPick || decision == Decision::kConfirm;
  }
  bool MovesParticles() const { return decision == Decision::kCorrect || decision == Decision::kPick; }
};

inline bool SameMeaning(const Answer& a, const Answer& b) {
  return a.scan == b.scan && a.decision == b.decision && a.reference == b.reference && a.end == b.end &&
         a.sigma == b.sigma && a.reference_from_scan.Vector() == b.reference_from_scan.Vector();
}

// In order of their scans, one for each at most.
using Answers = std::vector<Answer>;

}  // namespace survey
