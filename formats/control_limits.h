// SPDX-License-Identifier: Apache-2.0
//
// How long a file of control may be. A longer one was taken for it, such as a point cloud, and is refused where it
// becomes too long, before it fills the memory.
#pragma once

#include <cstddef>
#include <string>

#include "formats/errors.h"

namespace formats {

inline constexpr std::size_t kMostControlPoints = 200'000;  // five times what ten thousand blocks have
inline constexpr std::size_t kMostObservations = 1'000'000;

// `where` ends with ": ".
inline void RequireAtMost(std::size_t most, std::size_t count, const char* what, const std::string& where) {
  if (count <= most) return;
  throw DataError(where + "more than " + std::to_string(most) + " " + what +
                  ": no control is so long (a point cloud?)");
}

}  // namespace formats
