// SPDX-License-Identifier: Apache-2.0
//
// The certificate's picture of each match: what the map shows about a check feature, where the surveyor has it and
// where it was read in the map of each block.
#pragma once

#include <string>

#include "formats/certificate_html.h"

namespace formats {

// The windows of `map` (site.tif) about all check features of the certificate.
std::vector<FeatureWindow> ReadFeatureWindows(const std::filesystem::path& map, const survey::Certificate& certificate);

// Empty without windows.
std::string FeaturePicturesSection(const CertificatePage& page);

}  // namespace formats
