// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/paths.h"

namespace test_support {

// A file of the real data that tests use where it is there: below $PLUMBLINE_DATA, else ../shared/data beside the
// source tree. Tests skip what is missing.
inline std::optional<std::filesystem::path> RealData(const std::string& name) {
  const char* given = std::getenv("PLUMBLINE_DATA");
  const std::filesystem::path folder =
      given != nullptr ? std::filesystem::path(given) : SourceFolder() / "../shared/data";
  std::error_code error;
  if (!std::filesystem::exists(folder / name, error)) return std::nullopt;
  return folder / name;
}

}  // namespace test_support
