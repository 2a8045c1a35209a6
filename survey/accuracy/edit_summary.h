// SPDX-License-Identifier: Apache-2.0
//
// What people changed in the maps, as the certificate tells it. Features are measured in the maps as scanned, so that
// no edit takes part in a test of accuracy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace survey {

struct EditedBlock {
  std::string block;
  int num_edits = 0;
  std::int64_t edited_cells = 0;  // that show something else than the scans
  double max_shift_m = 0.0;       // farthest that an edit moved with its scans since it was drawn
};

struct EditSummary {
  int num_edits = 0;      // that set cells; one for an edit that reaches several blocks
  int num_forbidden = 0;  // areas that robots keep out of
  int num_masks = 0;      // areas whose returns were dropped
  std::vector<EditedBlock> blocks;
  std::vector<std::string> findings;  // sentences: people who contradict each other, newer scans, edits left behind
};

}  // namespace survey
