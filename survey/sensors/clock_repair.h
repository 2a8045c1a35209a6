// SPDX-License-Identifier: Apache-2.0
//
// Repair of a known fault of old logging programs: the microseconds of a stamp written without their leading zeros, so
// that 58 s + 40413 us reads 58.40413 and is padded to 58.404130. Every stamp in the first tenth of a second then comes
// out up to 0.9 s late, and sorting by stamp would shuffle scans and odometry. (The Intel Research Lab log has it.)
#pragma once

#include <vector>

#include "survey/sensors/session.h"

namespace survey {

// `stamps` in the order of logging. Returns what to add to each (0 or negative) so that as few as possible go back and
// the steps are as even as possible (a printed stamp ending in zeros may be several true ones, all as likely); empty
// when the log does not show the fault: stamps that go back, none within the first tenth of any second, and enough of
// them to tell (at least 200, of microsecond resolution).
std::vector<StampNs> RepairUnpaddedMicroseconds(const std::vector<StampNs>& stamps);

}  // namespace survey
