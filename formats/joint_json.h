// SPDX-License-Identifier: Apache-2.0
//
// The joint adjustment's summary in JSON, members under their own names: in joint.json and in the certificate.
#pragma once

#include "formats/json_values.h"
#include "survey/graph/joint_summary.h"

namespace survey {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JointBlock, name, rms_shift, max_shift, place_of_max, sigma_before, sigma_after)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JointPair, block_a, block_b, num_matches, num_used, rms_before, rms_after, sigma,
                                   contradicts)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JointSummary, num_control_points, num_shared, match_factor, blocks, pairs, apart)

}  // namespace survey
