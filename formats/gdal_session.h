// SPDX-License-Identifier: Apache-2.0
//
// The surroundings of every use of GDAL: drivers registered, no sidecar files written or looked for, and its error
// messages collected instead of printed, so that they end in a DataError that names our file.
#pragma once

#include <filesystem>
#include <string>

namespace formats {

class GdalSession {
 public:
  GdalSession();
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

  // DataError "FILE: RULE: what GDAL said" when a GDAL call failed since the session began, also where it only told
  // its error handler (a full disk is noticed when a data set is closed).
  void ThrowIfFailed(const std::filesystem::path& file, const std::string& rule) const;
  [[noreturn]] void Throw(const std::filesystem::path& file, const std::string& rule) const;

  void AddFailure(const std::string& message);
  const std::string& failure() const { return failure_; }

 private:
  std::string failure_;  // the first one
};

}  // namespace formats
