// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
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

// With blanks behind it, for columns of text.
inline std::string PaddedTo(std::size_t width, std::string text) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

}  // namespace pipeline
