// SPDX-License-Identifier: Apache-2.0
#include "stages/review/site_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "formats/errors.h"

namespace review {

SiteLock::SiteLock(const std::filesystem::path& site)
    : descriptor_(open((site / "site.toml").c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  if (descriptor_ >= 0) close(descriptor_);
  throw formats::DataError(site.string() + ": another plumbline review is at work on it");
}

SiteLock::~SiteLock() { close(descriptor_); }

}  // namespace review
