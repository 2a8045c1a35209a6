// SPDX-License-Identifier: Apache-2.0
//
// What the joint adjustment of a site found and changed. Lengths in metres, site frame (east, north).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace survey {

// A block that took part: how far its scans moved against the adjustment by its own control alone.
struct JointBlock {
  std::string name;
  double rms_shift = 0.0;
  double max_shift = 0.0;
  Eigen::Vector2d place_of_max = Eigen::Vector2d::Zero();
  double sigma_before = 0.0;  // of its positions: root mean square of sqrt(sigma_e2 + sigma_n2)
  double sigma_after = 0.0;
};

// Matches of the scans of one block in the map of another.
struct JointPair {
  std::string block_a, block_b;
  int num_matches = 0;
  int num_used = 0;         // the others contradict their neighbours, the control or the rest of the site
  double rms_before = 0.0;  // of the used ones, position against the blocks' own adjustments
  double rms_after = 0.0;
  double sigma = 0.0;        // what the covariances let expect of rms_before
  bool contradicts = false;  // most matches that agree with each other are beyond what the covariances allow
};

struct JointSummary {
  int num_control_points = 0;  // whose coordinates took part, each once
  int num_shared = 0;          // of these marked in more than one block
  double match_factor = 1.0;   // by which the matches' covariances were widened to what their residuals show
  std::vector<JointBlock> blocks;
  std::vector<JointPair> pairs;
  std::vector<std::string> apart;  // blocks that stay as they were: not tied to two control points
};

}  // namespace survey
