// SPDX-License-Identifier: Apache-2.0
//
// The two failures that are not our bug. Thrown anywhere, caught once in pipeline::RunStage.
#pragma once

#include <stdexcept>
#include <string>

namespace formats {

// Wrong command line or configuration: exit status 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Bad input data or an output that cannot be written: exit status 1. The message names file, row, field, value and
// rule, e.g. "control/points.csv:7: sigma_n = -0.002: a sigma must be positive".
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace formats
