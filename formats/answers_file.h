// SPDX-License-Identifier: Apache-2.0
//
// A person's answers, one JSON file each: blocks/B1/answers/*.json. Schema in README.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "survey/sensors/session.h"
#include "survey/submaps/answer.h"

namespace formats {

// In order of their scans, whatever the order of the files. `stamps`: of the block's scans on its clock. DataError
// names file, field, value and rule: unknown key, stamp of no scan, two answers for one scan (both named), sigma that
// is not positive, reference that is not earlier, pose farther off than anything the lidar sees there, wall too short.
survey::Answers ReadAnswers(const std::vector<std::filesystem::path>& files,
                            const std::vector<survey::StampNs>& stamps);

// What an answer means, as a line of text without its name and remarks.
std::string CanonicalLine(const survey::Answer& answer);

// What the answers mean, as text without comments, names and times of day: equal for equal meaning.
std::string CanonicalText(const survey::Answers& answers);

}  // namespace formats
