// SPDX-License-Identifier: Apache-2.0
#include "formats/starnet_stations.h"

#include "formats/text_numbers.h"

namespace formats {

using survey::CoordinateUse;

survey::NetworkPoint& StarnetStations::Name(const std::string& station, bool plane, const StarnetLine& line) {
  if (!clusters_.HasPoint(station)) {
    survey::NetworkPoint point{.name = station, .plane = CoordinateUse::kAdjusted};
    if (settings_.dimensions == 3) point.height = CoordinateUse::kAdjusted;
    clusters_.AddPoint(point, line.where());
  }
  has_plane_[station] |= plane;
  return *clusters_.Point(station);
}

// The state that !, *, & or a number in the place of a coordinate's standard deviation says; a number is returned.
std::optional<double> StarnetStations::CoordinateSigma(CoordinateUse* use, StarnetLine* line) const {
  if (!line->More()) return std::nullopt;
  const std::string& text = line->Word("standard deviation");
  if (text == "!") *use = CoordinateUse::kFixed;
  if (text == "!" || text == "*" || text == "&") return std::nullopt;
  const std::optional<double> sigma = ParseNumber(text);
  if (!sigma || *sigma <= 0.0)
    line->Fail("standard deviation = \"" + text + "\": must be !, *, & or a positive number");
  return *sigma * settings_.metres_per_unit;
}

void StarnetStations::Observe(const std::string& station, int component, double value, double sigma,
                              const StarnetLine& line) {
  NamedObservation named{.from = station};
  named.observation.kind = survey::ObservationKind::kCoordinate;
  named.observation.component = component;
  named.observation.value = value;
  named.observation.sigma = sigma;
  clusters_.Begin();
  clusters_.Add(named, line.where());
  clusters_.End();
}

void StarnetStations::ReadCoordinates(StarnetLine* line) {
  const std::string name = line->Word("the station");
  if (!settings_.north_first) {
    const std::string a = line->Word("a coordinate"), b = line->Word("a coordinate");
    line->Fail("the order of coordinates must be told: station " + name + " has north " + a + ", east " + b +
               " with .ORDER NE, or north " + b + ", east " + a + " with .ORDER EN");
  }
  const bool north_first = *settings_.north_first;
  const auto length = [&](const char* what) { return line->Number(what) * settings_.metres_per_unit; };
  const double first = length("the first coordinate"), second = length("the second coordinate");
  survey::NetworkPoint& point = Name(name, true, *line);
  if (point.plane_known) line->Fail("station " + name + " has coordinates already");
  point.position.head<2>() = north_first ? Eigen::Vector2d(second, first) : Eigen::Vector2d(first, second);
  point.plane_known = true;
  if (settings_.dimensions == 3) {
    point.position.z() = length("the elevation");
    point.height_known = true;
  }
  CoordinateUse use[3] = {CoordinateUse::kAdjusted, CoordinateUse::kAdjusted, CoordinateUse::kAdjusted};
  for (int k = 0; k < settings_.dimensions; ++k) {
    const int component = k < 2 && north_first ? 1 - k : k;
    if (const auto sigma = CoordinateSigma(&use[component], line))
      Observe(name, component, point.position[component], *sigma, *line);
  }
  if ((use[0] == CoordinateUse::kFixed) != (use[1] == CoordinateUse::kFixed))
    line->Fail("station " + name + ": north and east must both be fixed, or neither");
  point.plane = use[0];
  if (settings_.dimensions == 3) point.height = use[2];
}

void StarnetStations::ReadElevation(StarnetLine* line) {
  survey::NetworkPoint& point = Name(line->Word("the station"), false, *line);
  point.position.z() = line->Number("the elevation") * settings_.metres_per_unit;
  point.height_known = true;
  point.height = CoordinateUse::kAdjusted;
  if (const auto sigma = CoordinateSigma(&point.height, line))
    Observe(point.name, 2, point.position.z(), *sigma, *line);
}

void StarnetStations::Settle() {
  for (const auto& [name, has_plane] : has_plane_) {
    if (!has_plane) clusters_.Point(name)->plane = CoordinateUse::kUnused;
  }
}

}  // namespace formats
