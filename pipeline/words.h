// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace pipeline {

// The words of a text that blanks separate.
inline std::vector<std::string> Words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

}  // namespace pipeline
