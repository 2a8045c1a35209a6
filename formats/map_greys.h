// SPDX-License-Identifier: Apache-2.0
//
// The greys of maps as pictures.
#pragma once

#include <cstdint>

namespace formats {

// White up to the free threshold of ROS map_server, black from its occupied one, shades between.
std::uint8_t PictureGrey(float log_odds);

// The three greys of ROS map_server's saver.
std::uint8_t RosGrey(float log_odds);

}  // namespace formats
