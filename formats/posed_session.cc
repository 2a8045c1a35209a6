// SPDX-License-Identifier: Apache-2.0
#include "formats/posed_session.h"

#include <string>

#include "formats/artefacts.h"
#include "formats/errors.h"

namespace formats {

PosedSession ReadPosedSession(const std::filesystem::path& session_file, const std::filesystem::path& solution_file) {
  PosedSession posed{.session = ReadSession(session_file), .solution = ReadSolution(solution_file)};
  const std::size_t num_scans = posed.session.scans.size();
  if (posed.solution.scans.size() != num_scans)
    throw DataError(solution_file.string() + ": has " + std::to_string(posed.solution.scans.size()) + " scans, " +
                    session_file.string() + " has " + std::to_string(num_scans) + ": they do not belong together");
  posed.site_from_scan.reserve(num_scans);
  for (const survey::SolvedScan& scan : posed.solution.scans) posed.site_from_scan.push_back(scan.site_from_scan);
  return posed;
}

}  // namespace formats
