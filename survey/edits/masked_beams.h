// SPDX-License-Identifier: Apache-2.0
//
// Returns that a person wants dropped: mirror images behind glass, people who stood about. A mask is an area of the map
// when it is drawn; from then on it is the beams whose end points lay in it, so that it holds whatever becomes of the
// poses and does not depend on them.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "survey/edits/map_edit.h"
#include "survey/geometry/pose2.h"
#include "survey/sensors/session.h"

namespace survey {

// Runs of beams of the mask's time with end points in its area, in order of scans and beams. Poses: of every scan, in
// the session's order.
std::vector<MaskedBeams> BeamsInside(const MapEdit& area, const Session& session,
                                     const std::vector<Pose2>& site_from_scan);

// The beams tell nothing any more (kInvalidRange). Returns how many were dropped; stamps of no scan are passed over.
std::size_t DropBeams(std::span<const MaskedBeams> beams, Session* session);

}  // namespace survey
