// SPDX-License-Identifier: Apache-2.0
//
// The clocks of CARMEN logs, made to run: the rules are in README.md, "CARMEN logs".
#pragma once

#include <vector>

#include "formats/carmen_messages.h"
#include "formats/field_data.h"

namespace formats {

// Repairs the stamps of both in place and tells of it in `data`. Returns for each laser line its new stamp minus the
// printed one where poses are to be handed out under the printed one, else 0.
std::vector<survey::StampNs> RepairClock(std::vector<CarmenLaser>* lasers, std::vector<CarmenOdometry>* odometry,
                                         FieldData* data);

}  // namespace formats
