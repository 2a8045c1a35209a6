// SPDX-License-Identifier: Apache-2.0
#include "pipeline/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "formats/errors.h"

namespace pipeline {
namespace {

int Report(int status, const std::string& message) {
  std::cerr << "plumbline: " << message << std::endl;
  return status;
}

}  // namespace

bool ParseArguments(std::vector<std::string> arguments, CLI::App* app) {
  std::reverse(arguments.begin(), arguments.end());
  try {
    app->parse(arguments);
    return true;
  } catch (const CLI::Success& success) {
    app->exit(success);
    return false;
  } catch (const CLI::ParseError& error) {
    throw formats::UsageError(std::string(error.what()) + " (see plumbline --help)");
  }
}

int RunProgram(const std::function<int()>& body) {
  try {
    return body();
  } catch (const formats::UsageError& error) {
    return Report(2, error.what());
  } catch (const formats::DataError& error) {
    return Report(1, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return Report(1, error.path1().string() + ": " + error.code().message());
  } catch (const std::exception& error) {
    return Report(3, std::string("internal error: ") + error.what() + "; please report it");
  }
}

}  // namespace pipeline
