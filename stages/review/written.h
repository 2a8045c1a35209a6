// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace review {

// What came of a wish to write.
struct Written {
  enum class Outcome {
    kDone,
    kStale,   // somebody else wrote since the state that the writer has seen
    kRefused  // it breaks a rule
  };
  Outcome outcome = Outcome::kDone;
  std::string message;  // why not: field, value and rule
  std::string tag;      // of the state that is there now; empty: nothing is there
};

}  // namespace review
