// SPDX-License-Identifier: Apache-2.0
//
// What a person with an AR client sent back over rosbridge: an edited map becomes edits, a pose an answer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/rosbridge.h"

namespace pipeline {

// What a person made of the map that `plumbline rosbridge` wrote, as edits of cells. `where` begins complaints.
std::vector<survey::MapEdit> EditsOfRosGrid(const std::filesystem::path& site, const formats::RosGrid& grid,
                                            const std::string& where);

// Writes poses of the robot as answers in site coordinates, blocks/B/answers/rosbridge-STAMP.json. DataError, and
// nothing is written, for a stamp of no scan or of two blocks, and for a scan that was answered so before.
void RecordPoses(const std::filesystem::path& site, const std::vector<formats::RosPose>& poses, const std::string& who,
                 const std::string& where);

}  // namespace pipeline
