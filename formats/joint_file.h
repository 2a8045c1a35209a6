// SPDX-License-Identifier: Apache-2.0
//
// joint.json: what the joint adjustment of a site found and changed.
#pragma once

#include <filesystem>

#include "formats/provenance.h"
#include "survey/graph/joint_summary.h"

namespace formats {

void WriteJoint(const std::filesystem::path& file, const survey::JointSummary& summary, const Provenance& provenance);

// DataError names the file when it is not a joint.json of this version.
survey::JointSummary ReadJoint(const std::filesystem::path& file);

}  // namespace formats
