// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace review {

inline std::string ReplacedAll(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace review
