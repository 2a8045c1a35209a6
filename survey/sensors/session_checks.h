// SPDX-License-Identifier: Apache-2.0
//
// What must hold of a session before any stage works with it. Pure: returns what is wrong, for the caller to name the
// file and row.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "survey/sensors/session.h"

namespace survey {

enum class SessionPart { kScans, kImu, kOdometry, kMarks };

struct SessionFault {
  SessionPart part = SessionPart::kScans;
  std::size_t index = 0;  // of the scan, sample or mark
  std::string message;
};

// Empty when the session is sound: it has scans; stamps grow; scans fit their geometry; numbers are finite; IMU and
// odometry run at the time of the scans; marks begin before they end, lie within the scans (to the second: they are
// often written so), hold a scan and do not overlap.
std::vector<SessionFault> CheckSession(const Session& session);

// Oddities that a person should know of: long gaps between scans or odometry, scans without a return.
std::vector<std::string> SessionWarnings(const Session& session);

}  // namespace survey
