// SPDX-License-Identifier: Apache-2.0
//
// The certificate's section on the control itself.
#pragma once

#include <string>
#include <vector>

#include "survey/accuracy/control_reliability.h"

namespace formats {

// Empty without tied blocks.
std::string ReliabilitySection(const std::vector<survey::BlockReliability>& blocks);

}  // namespace formats
