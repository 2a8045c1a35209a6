// SPDX-License-Identifier: Apache-2.0
//
// Sentences on what the checks of a site do not tell: blocks and checks that were not tested, places far from control,
// tests that rest on too little.
#pragma once

#include <string>
#include <vector>

#include "survey/accuracy/certify.h"

namespace survey {

// `certificate` is complete except for these sentences.
std::vector<std::string> ListNotTested(const CertifyInput& input, const Certificate& certificate);

}  // namespace survey
