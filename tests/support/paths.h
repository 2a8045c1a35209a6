// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace test_support {

// The executables of this build, and the top of the source tree.
std::filesystem::path BinFolder();
std::filesystem::path SourceFolder();

}  // namespace test_support
