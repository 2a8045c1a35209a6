// SPDX-License-Identifier: Apache-2.0
//
// Artefacts as text for people. For exact numbers there is the sqlite3 shell.
#pragma once

#include <filesystem>
#include <ostream>

namespace formats {

// Any artefact: what it is, where it comes from, what it holds. DataError when the file is none or damaged.
void PrintArtefact(const std::filesystem::path& file, std::ostream& out);

// The poses of a track (local frame) or solution (site frame) as TUM lines `t x y z qx qy qz qw`, one per scan, z = 0,
// ordered by t: the scans' stamps as the raw log prints them, s, exact to the nanosecond. DataError on other artefacts.
void PrintTumTrajectory(const std::filesystem::path& file, std::ostream& out);

}  // namespace formats
