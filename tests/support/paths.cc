// SPDX-License-Identifier: Apache-2.0
#include "tests/support/paths.h"

namespace test_support {

std::filesystem::path BinFolder() { return PLUMBLINE_BIN_DIR; }
std::filesystem::path SourceFolder() { return PLUMBLINE_SOURCE_DIR; }

}  // namespace test_support
