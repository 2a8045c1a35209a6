// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "pipeline/stage.h"

namespace pipeline {
namespace {

std::string Duration(double seconds) {
  char buffer[64];
  if (seconds < 90) {
    std::snprintf(buffer, sizeof buffer, "%.0f s", seconds);
  } else {
    std::snprintf(buffer, sizeof buffer, "%.0f min", seconds / 60);
  }
  return buffer;
}

// Under `make -j` several stages share the terminal: their progress lines would overwrite each other.
bool OneOfManyJobs() {
  const char* flags = std::getenv("MAKEFLAGS");
  return flags != nullptr && std::string_view(flags).find("--jobserver") != std::string_view::npos;
}

}  // namespace

Progress::Progress(std::string program, std::string what, std::int64_t total, bool enabled)
    : program_(std::move(program)),
      what_(std::move(what)),
      total_(total),
      enabled_(enabled && isatty(2) == 1 && !OneOfManyJobs()),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (printed_) std::fprintf(stderr, "\r\033[K");
}

void Progress::Advance(std::int64_t done) {
  if (!enabled_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  printed_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(done) / elapsed;
  const double left = rate > 0 ? static_cast<double>(total_ - done) / rate : 0;
  std::fprintf(stderr, "\r\033[K%s: %s %lld of %lld, %.0f/s, %s left", program_.c_str(), what_.c_str(),
               static_cast<long long>(done), static_cast<long long>(total_), rate, Duration(left).c_str());
}

}  // namespace pipeline
