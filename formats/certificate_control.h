// SPDX-License-Identifier: Apache-2.0
//
// The certificate's sections on control: cross-validated, fit, and the list with its adjustment.
#pragma once

#include <string>

#include "survey/accuracy/certificate.h"

namespace formats {

// Each empty where there is nothing to say.
std::string ControlUsedSection(const survey::Certificate& certificate);
std::string ControlListSection(const survey::Certificate& certificate);

}  // namespace formats
