// SPDX-License-Identifier: Apache-2.0
//
// Drawings of how the errors of the checks are distributed, as inline SVG.
#pragma once

#include <string>

#include "survey/accuracy/certificate.h"

namespace formats {

// Errors of one kind by axis, about their mean and over their standard deviation, against normal quantiles.
std::string QuantilePlotSvg(const survey::Certificate& certificate, survey::CheckKind kind);

// Lengths of the errors against the distance to the nearest used control.
std::string ControlDistanceSvg(const survey::Certificate& certificate);

}  // namespace formats
