// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace review {

// Keeps a second review server off a site: it could not know what this one has just written. No file is made: site.toml
// is locked, which hinders nobody else.
class SiteLock {
 public:
  explicit SiteLock(const std::filesystem::path& site);  // DataError when the site is being reviewed already
  ~SiteLock();
  SiteLock(const SiteLock&) = delete;
  SiteLock& operator=(const SiteLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace review
