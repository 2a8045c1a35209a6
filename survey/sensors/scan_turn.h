// SPDX-License-Identifier: Apache-2.0
//
// Which way the scans turn: a scanner that hangs upside down, or whose beams are numbered the other way round, shows a
// room that turns with the platform instead of against it. Told without matching: a turn shifts the profile of ranges.
#pragma once

#include <functional>
#include <optional>

#include "survey/sensors/session.h"

namespace survey {

// Heading of the platform by another sensor (odometry or gyro), rad, not wrapped between two calls that are less than a
// second apart; empty where it is not known.
using HeadingOfTime = std::function<std::optional<double>(StampNs)>;

struct TurnVotes {
  int with = 0;     // pairs of scans that turn as the other sensor says
  int against = 0;  // that turn the other way
};

// Compares up to `max_pairs` pairs of scans between which the other sensor turns by 0.1 to 0.4 rad.
TurnVotes CompareScanTurns(const Session& session, const HeadingOfTime& heading, int max_pairs);

}  // namespace survey
