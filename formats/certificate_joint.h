// SPDX-License-Identifier: Apache-2.0
//
// The certificate's section on the joint adjustment.
#pragma once

#include <string>

#include "survey/graph/joint_summary.h"

namespace formats {

std::string JointSection(const survey::JointSummary& joint);

}  // namespace formats
