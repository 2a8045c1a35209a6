// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file_state.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "formats/errors.h"

namespace pipeline {

std::string FileState(const std::filesystem::path& file) {
  struct stat state {};
  if (stat(file.c_str(), &state) != 0) throw formats::DataError(file.string() + ": " + std::strerror(errno));
  return std::to_string(state.st_size) + " bytes, modified " + std::to_string(state.st_mtim.tv_sec) + " s " +
         std::to_string(state.st_mtim.tv_nsec) + " ns";
}

}  // namespace pipeline
