// SPDX-License-Identifier: Apache-2.0
//
// Running other programs: to read what they print, or to become them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pipeline {

struct ProgramOutput {
  int status = 0;  // exit status; 128 + signal when killed
  std::string out;
};

// Folder of the running executable.
std::filesystem::path OwnFolder();

// Runs argv[0] (a path, or a name on PATH) and waits; stderr goes where ours goes. DataError when it cannot be started.
ProgramOutput RunAndRead(const std::vector<std::string>& argv);

// Runs argv[0] with our stdin, stdout and stderr; returns the exit status, 128 + signal when killed.
int RunAndWait(const std::vector<std::string>& argv);

// Becomes argv[0]. Returns only by DataError when it cannot be started.
[[noreturn]] void Become(const std::vector<std::string>& argv);

}  // namespace pipeline
