// SPDX-License-Identifier: Apache-2.0
//
// The stations of a STAR*NET file: C and E lines, and stations that only observations name.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "formats/network_cluster.h"
#include "formats/starnet_settings.h"

namespace formats {

class StarnetStations {
 public:
  StarnetStations(const StarnetSettings& settings, NetworkClusters* clusters)
      : settings_(settings), clusters_(*clusters) {}

  // What follows C or E on the line. Coordinates with a standard deviation become observations.
  void ReadCoordinates(StarnetLine* line);
  void ReadElevation(StarnetLine* line);

  // A station that is named; `plane` when something observes its place in the plane.
  survey::NetworkPoint& Name(const std::string& station, bool plane, const StarnetLine& line);

  // When all lines are read: a station that is only levelled has no place in the plane.
  void Settle();

 private:
  std::optional<double> CoordinateSigma(survey::CoordinateUse* use, StarnetLine* line) const;
  void Observe(const std::string& station, int component, double value, double sigma, const StarnetLine& line);

  const StarnetSettings& settings_;
  NetworkClusters& clusters_;
  std::map<std::string, bool> has_plane_;
};

}  // namespace formats
