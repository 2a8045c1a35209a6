// SPDX-License-Identifier: Apache-2.0
//
// The certificate's sections on classes and on how the errors of the checks behave, as HTML.
#pragma once

#include <string>

#include "survey/accuracy/certificate.h"

namespace formats {

// The classes of standards and contracts, each with its statistic, confidence level and source; empty without checks.
std::string ClassesSection(const survey::Certificate& certificate);

// Normality, outliers, clusters and spread of the checks, with their drawings; empty without checks.
std::string AnalysisSection(const survey::Certificate& certificate);

}  // namespace formats
