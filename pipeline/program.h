// SPDX-License-Identifier: Apache-2.0
//
// What the programs that are not stages share: the front command and `plumbline new`.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pipeline {

// Parses with CLI11; false when help was asked for and printed. UsageError.
bool ParseArguments(std::vector<std::string> arguments, CLI::App* app);

// Runs `body` and returns its status, or that of the error, whose message goes to stderr.
int RunProgram(const std::function<int()>& body);

}  // namespace pipeline
