// SPDX-License-Identifier: Apache-2.0
//
// Stamps that stand together although the sensor kept its pace: a logger that writes whole seconds gives several scans
// one stamp, one that empties a buffer late stamps ten scans within milliseconds and then none for two seconds. Offline
// the pace is known and the stamps are spread again.
#pragma once

#include <vector>

#include "survey/sensors/session.h"

namespace survey {

// Share of the stamps that equal the one before.
double ShareOfEqual(const std::vector<StampNs>& stamps);

// `stamps` of one sensor in the order of logging. Returns what to add to each; empty when the log does not show the
// fault: more than a twentieth of the stamps equal to the one before, or four fifths of them within a tenth of the mean
// step behind it. Equal stamps were cut off and spread forward to the next one, a burst was stamped when the buffer was
// emptied and is spread back to the one before; steps are at most twice the usual ones. Empty, too, when all stamps are
// equal: nothing is known then.
std::vector<StampNs> SpreadBursts(const std::vector<StampNs>& stamps);

}  // namespace survey
