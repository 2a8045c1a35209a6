// SPDX-License-Identifier: Apache-2.0
//
// A plane network's observations arranged for the computation of approximate coordinates: rays of one station that
// share an orientation, and horizontal distances.
#pragma once

#include <optional>
#include <vector>

#include "survey/network/network.h"

namespace survey {

struct Ray {
  int target = -1;
  double reading = 0.0;  // rad, clockwise
};

// A direction set, an angle (two rays), or an azimuth (one ray, oriented).
struct Bundle {
  int station = -1;
  bool oriented = false;  // readings are azimuths
  std::vector<Ray> rays;
};

struct Sights {
  struct Length {
    int other = -1;
    double distance = 0.0;
  };
  struct Incoming {
    int bundle = -1;
    double reading = 0.0;
  };
  struct Shift {  // a coordinate difference: other = point + shift, one component
    int other = -1;
    int component = 0;
    double value = 0.0;
  };
  std::vector<Bundle> bundles;
  // By point:
  std::vector<std::vector<int>> bundles_of;     // whose station it is
  std::vector<std::vector<Incoming>> incoming;  // rays to it
  std::vector<std::vector<Length>> lengths;
  std::vector<std::vector<Shift>> shifts;

  std::optional<double> Distance(int a, int b) const;
};

// Slope distances are reduced with the zenith angle of the same sight, else with known heights; else they are taken as
// they are.
Sights SightsOf(const Network& network);

}  // namespace survey
