// SPDX-License-Identifier: Apache-2.0
//
// The certificate's drawings as inline SVG.
#pragma once

#include <string>

#include "formats/certificate_html.h"

namespace formats {

// The map with control, checks and trajectories; error vectors of the checks and residuals of used control, enlarged
// by a round factor, with a scale bar for either.
std::string ResidualMapSvg(const CertificatePage& page);

// Errors of the checks around the origin with the class circle and the circle that holds 95 %.
std::string ErrorScatterSvg(const survey::Certificate& certificate);

}  // namespace formats
