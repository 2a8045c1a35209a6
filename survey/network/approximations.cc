// SPDX-License-Identifier: Apache-2.0
#include "survey/network/approximations.h"

#include <cmath>

#include "survey/network/plane_piece.h"

namespace survey {
namespace {

bool InUse(CoordinateUse use) { return use != CoordinateUse::kUnused; }

// A piece of its own around one station: its polar points, or one target at unit distance where there are no lengths.
PlanePiece LocalPiece(const Sights& sights, const Bundle& bundle) {
  bool metric = false;
  for (const Ray& ray : bundle.rays) metric = metric || sights.Distance(bundle.station, ray.target).has_value();
  PlanePiece piece(sights, metric, bundle.oriented);
  piece.Set(bundle.station, Eigen::Vector2d::Zero());
  for (const Ray& ray : bundle.rays) {
    const std::optional<double> distance =
        metric ? sights.Distance(bundle.station, ray.target) : std::optional<double>(1.0);
    if (!distance) continue;
    piece.Set(ray.target, *distance * Eigen::Vector2d(std::sin(ray.reading), std::cos(ray.reading)));
    if (!metric) break;
  }
  piece.Grow();
  return piece;
}

bool AttachSomePiece(const Sights& sights, PlanePiece* main) {
  for (const Bundle& bundle : sights.bundles) {
    bool brings_new = !main->Knows(bundle.station);
    for (const Ray& ray : bundle.rays) brings_new = brings_new || !main->Knows(ray.target);
    if (!brings_new) continue;
    const PlanePiece piece = LocalPiece(sights, bundle);
    const int before = main->size();
    if (main->Attach(piece) && main->size() > before) return true;
  }
  return false;
}

void ComputePlane(Network* network) {
  const Sights sights = SightsOf(*network);
  PlanePiece main(sights, true, true);
  bool complete = true;
  for (std::size_t i = 0; i < network->points.size(); ++i) {
    const NetworkPoint& point = network->points[i];
    if (point.plane_known) main.Set(static_cast<int>(i), point.position.head<2>());
    complete = complete && (point.plane_known || !InUse(point.plane));
  }
  if (complete) return;
  if (main.size() == 0) {  // a network without any coordinates lies anywhere
    const Bundle* largest = nullptr;
    for (const Bundle& bundle : sights.bundles) {
      if (largest == nullptr || bundle.rays.size() > largest->rays.size()) largest = &bundle;
    }
    if (largest != nullptr) main = LocalPiece(sights, *largest);
  }
  main.Grow();
  while (AttachSomePiece(sights, &main)) main.Grow();
  for (std::size_t i = 0; i < network->points.size(); ++i) {
    NetworkPoint& point = network->points[i];
    if (point.plane_known || !main.Knows(static_cast<int>(i))) continue;
    point.position.head<2>() = main.At(static_cast<int>(i));
    point.plane_known = true;
  }
}

// Height of `to` minus height of `from` by one observation, where the plane coordinates that it needs are known.
std::optional<double> Rise(const Network& network, const Observation& o) {
  if (o.kind == ObservationKind::kHeightDifference) return o.value;
  if (o.kind == ObservationKind::kDifference && o.component == 2) return o.value;
  if (o.kind != ObservationKind::kZenithAngle) return std::nullopt;
  const NetworkPoint& from = network.points[static_cast<std::size_t>(o.from)];
  const NetworkPoint& to = network.points[static_cast<std::size_t>(o.to)];
  if (!from.plane_known || !to.plane_known) return std::nullopt;
  const double distance = (to.position - from.position).head<2>().norm() / network.geometry.combined_factor;
  return distance / std::tan(o.value) + o.instrument_height - o.target_height;
}

void ComputeHeights(Network* network) {
  for (const Observation& o : network->observations) {
    NetworkPoint& point = network->points[static_cast<std::size_t>(o.from)];
    const bool height =
        o.kind == ObservationKind::kHeight || (o.kind == ObservationKind::kCoordinate && o.component == 2);
    if (!height || point.height_known) continue;
    point.position.z() = o.value;
    point.height_known = true;
  }
  for (bool more = true; more;) {
    more = false;
    for (const Observation& o : network->observations) {
      const std::optional<double> rise = o.to < 0 ? std::nullopt : Rise(*network, o);
      if (!rise) continue;
      NetworkPoint& from = network->points[static_cast<std::size_t>(o.from)];
      NetworkPoint& to = network->points[static_cast<std::size_t>(o.to)];
      if (from.height_known == to.height_known) continue;
      NetworkPoint& found = from.height_known ? to : from;
      found.position.z() = from.height_known ? from.position.z() + *rise : to.position.z() - *rise;
      found.height_known = more = true;
    }
  }
}

void TakeObservedCoordinates(Network* network) {
  std::vector<int> seen(network->points.size(), 0);
  for (const Observation& o : network->observations) {
    NetworkPoint& point = network->points[static_cast<std::size_t>(o.from)];
    if (o.kind != ObservationKind::kCoordinate || o.component == 2 || point.plane_known) continue;
    point.position[o.component] = o.value;
    int& components = seen[static_cast<std::size_t>(o.from)];
    components |= 1 << o.component;
    point.plane_known = components == 3;
  }
}

bool NoHeightKnown(const Network& network) {
  for (const NetworkPoint& point : network.points) {
    if (point.height_known) return false;
  }
  return true;
}

}  // namespace

std::vector<int> ComputeApproximations(Network* network) {
  if (!network->geometry.geocentric) {
    TakeObservedCoordinates(network);
    ComputeHeights(network);
    if (NoHeightKnown(*network)) {  // a levelling network without any height begins at zero
      for (NetworkPoint& point : network->points) {
        if (!InUse(point.height)) continue;
        point.height_known = true;
        break;
      }
      ComputeHeights(network);
    }
    ComputePlane(network);
    ComputeHeights(network);
  }
  std::vector<int> missing;
  for (std::size_t i = 0; i < network->points.size(); ++i) {
    const NetworkPoint& point = network->points[i];
    if ((InUse(point.plane) && !point.plane_known) || (InUse(point.height) && !point.height_known)) {
      missing.push_back(static_cast<int>(i));
    }
  }
  return missing;
}

}  // namespace survey
