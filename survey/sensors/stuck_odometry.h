// SPDX-License-Identifier: Apache-2.0
//
// Wheel odometry that stops to count: it reports one pose for long while the scans show that the platform drives on.
// Taken for a platform that stands still it would hold back the matches wherever they are weak, as in corridors.
#pragma once

#include <string>
#include <vector>

#include "survey/sensors/session.h"

namespace survey {

// Takes such samples out and says from when to when. A stretch counts when one pose stands for 10 s or more, and for 10
// s of it most beams read otherwise than at its beginning.
std::vector<std::string> DropStuckOdometry(Session* session);

}  // namespace survey
