// SPDX-License-Identifier: Apache-2.0
//
// The certificate's section on what changed since the last delivery.
#pragma once

#include <string>

#include "survey/accuracy/delivery.h"

namespace formats {

std::string ChangesSection(const survey::DeliveryChanges& changes);

}  // namespace formats
