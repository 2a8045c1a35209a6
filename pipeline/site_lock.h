// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace pipeline {

// Keeps a second `make` off a site: locks site/work/.lock until process `make` ends (a small process waits for that end
// and holds the lock, so nothing stale can stay behind, however make ends). DataError tells who holds it.
void LockSiteUntilEndOf(const std::filesystem::path& site, pid_t make);

// Whether somebody holds the lock just now.
bool SiteIsLocked(const std::filesystem::path& site);

// Of the machine that this runs on.
std::string HostName();

}  // namespace pipeline
