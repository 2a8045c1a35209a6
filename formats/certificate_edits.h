// SPDX-License-Identifier: Apache-2.0
//
// What people changed in the maps, as a section of the certificate's page.
#pragma once

#include <string>

#include "survey/accuracy/edit_summary.h"

namespace formats {

std::string EditsSection(const survey::EditSummary& edits);

}  // namespace formats
