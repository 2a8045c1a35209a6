// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace test_support {

struct CommandResult {
  int status = -1;  // exit status; 128 + signal when killed
  std::string out;
  std::string err;
};

// Runs a program of the build ("plumbline-track", or an absolute path) and waits for it.
CommandResult RunCommand(const std::vector<std::string>& command, const std::string& working_folder = ".");

}  // namespace test_support
