// SPDX-License-Identifier: Apache-2.0
#include "survey/network/sights.h"

#include <cmath>
#include <map>
#include <utility>

namespace survey {
namespace {

using Pair = std::pair<int, int>;

double Horizontal(const Network& network, const Observation& slope, const std::map<Pair, double>& zenith_angles) {
  const auto zenith = zenith_angles.find({slope.from, slope.to});
  if (zenith != zenith_angles.end()) return slope.value * std::sin(zenith->second);
  const NetworkPoint& from = network.points[static_cast<std::size_t>(slope.from)];
  const NetworkPoint& to = network.points[static_cast<std::size_t>(slope.to)];
  if (!from.height_known || !to.height_known) return slope.value;
  const double rise = to.position.z() + slope.target_height - from.position.z() - slope.instrument_height;
  return std::sqrt(std::max(0.0, slope.value * slope.value - rise * rise));
}

void AddBundle(Bundle bundle, Sights* sights) {
  const int index = static_cast<int>(sights->bundles.size());
  sights->bundles_of[static_cast<std::size_t>(bundle.station)].push_back(index);
  for (const Ray& ray : bundle.rays) {
    sights->incoming[static_cast<std::size_t>(ray.target)].push_back({index, ray.reading});
  }
  sights->bundles.push_back(std::move(bundle));
}

void AddLength(int a, int b, double distance, Sights* sights) {
  sights->lengths[static_cast<std::size_t>(a)].push_back({b, distance});
  sights->lengths[static_cast<std::size_t>(b)].push_back({a, distance});
}

}  // namespace

std::optional<double> Sights::Distance(int a, int b) const {
  for (const Length& length : lengths[static_cast<std::size_t>(a)]) {
    if (length.other == b) return length.distance;
  }
  return std::nullopt;
}

Sights SightsOf(const Network& network) {
  Sights sights;
  const double factor = network.geometry.combined_factor;
  const std::size_t count = network.points.size();
  sights.bundles_of.resize(count);
  sights.incoming.resize(count);
  sights.lengths.resize(count);
  sights.shifts.resize(count);
  std::map<Pair, double> zenith_angles;
  for (const Observation& o : network.observations) {
    if (o.kind == ObservationKind::kZenithAngle) zenith_angles.emplace(Pair(o.from, o.to), o.value);
  }
  std::map<int, Bundle> sets;
  for (const Observation& o : network.observations) {
    switch (o.kind) {
      case ObservationKind::kDirection:
        sets[o.set].station = o.from;
        sets[o.set].rays.push_back({o.to, o.value});
        break;
      case ObservationKind::kAngle:
        AddBundle({.station = o.from, .rays = {{o.to, 0.0}, {o.fore, o.value}}}, &sights);
        break;
      case ObservationKind::kAzimuth:
        AddBundle({.station = o.from, .oriented = true, .rays = {{o.to, o.value}}}, &sights);
        break;
      case ObservationKind::kDistance:
        AddLength(o.from, o.to, factor * o.value, &sights);
        break;
      case ObservationKind::kSlopeDistance:
        AddLength(o.from, o.to, factor * Horizontal(network, o, zenith_angles), &sights);
        break;
      case ObservationKind::kDifference:
        if (o.component == 2) break;
        sights.shifts[static_cast<std::size_t>(o.from)].push_back({o.to, o.component, factor * o.value});
        sights.shifts[static_cast<std::size_t>(o.to)].push_back({o.from, o.component, -factor * o.value});
        break;
      default:
        break;
    }
  }
  for (auto& [set, bundle] : sets) AddBundle(std::move(bundle), &sights);
  return sights;
}

}  // namespace survey
