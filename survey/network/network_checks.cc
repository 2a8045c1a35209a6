// SPDX-License-Identifier: Apache-2.0
#include "survey/network/network_checks.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace survey {
namespace {

bool HasFooting(const NetworkPoint& point) {
  const auto footing = [](CoordinateUse use) {
    return use == CoordinateUse::kFixed || use == CoordinateUse::kConstrained;
  };
  return footing(point.plane) || footing(point.height);
}

bool InUse(const NetworkPoint& point) {
  return point.plane != CoordinateUse::kUnused || point.height != CoordinateUse::kUnused;
}

bool IsAdjusted(const NetworkPoint& point) { return point.IsUnknown(0) || point.IsUnknown(2); }

// Points that observations tie together, directly or not.
class Components {
 public:
  explicit Components(const Network& network) : parent_(network.points.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const Observation& o : network.observations) {
      if (o.to >= 0) Join(o.from, o.to);
      if (o.fore >= 0) Join(o.from, o.fore);
    }
    for (const CorrelatedObservations& group : network.correlated) {
      const std::size_t end = group.first + static_cast<std::size_t>(group.covariance.rows());
      for (std::size_t k = group.first + 1; k < end; ++k) {
        Join(network.observations[group.first].from, network.observations[k].from);
      }
    }
  }
  int Of(int point) {
    int root = point;
    while (parent_[static_cast<std::size_t>(root)] != root) root = parent_[static_cast<std::size_t>(root)];
    while (parent_[static_cast<std::size_t>(point)] != root) {
      point = std::exchange(parent_[static_cast<std::size_t>(point)], root);
    }
    return root;
  }

 private:
  void Join(int a, int b) { parent_[static_cast<std::size_t>(Of(a))] = Of(b); }
  std::vector<int> parent_;
};

// Conditions that the observations put on each point's plane coordinates and height. The first direction of a station's
// set is used up by its orientation.
struct Conditions {
  int plane = 0, height = 0;
  std::string last;  // one of them in words
};

bool NeedsPlane(const Observation& o) {
  switch (o.kind) {
    case ObservationKind::kHeightDifference:
    case ObservationKind::kHeight:
      return false;
    case ObservationKind::kCoordinate:
    case ObservationKind::kDifference:
      return o.component < 2;
    default:
      return true;
  }
}

bool NeedsHeight(const Observation& o) {
  return !NeedsPlane(o) || o.kind == ObservationKind::kSlopeDistance || o.kind == ObservationKind::kZenithAngle;
}

std::vector<Conditions> CountConditions(const Network& network) {
  std::vector<Conditions> conditions(network.points.size());
  std::vector<bool> set_begun(static_cast<std::size_t>(network.num_sets), false);
  for (const Observation& o : network.observations) {
    for (const int point : {o.from, o.to, o.fore}) {
      if (point < 0) continue;
      Conditions& of_point = conditions[static_cast<std::size_t>(point)];
      bool free_direction = false;
      if (o.kind == ObservationKind::kDirection && point == o.from) {
        free_direction = !set_begun[static_cast<std::size_t>(o.set)];
        set_begun[static_cast<std::size_t>(o.set)] = true;
      }
      if (NeedsPlane(o) && !free_direction) ++of_point.plane;
      if (NeedsHeight(o) || network.geometry.geocentric) ++of_point.height;
      of_point.last = std::string(Name(o.kind)) + " from " + network.points[static_cast<std::size_t>(o.from)].name +
                      (o.to < 0 ? "" : " to " + network.points[static_cast<std::size_t>(o.to)].name);
    }
  }
  return conditions;
}

}  // namespace

std::string ListedNames(const Network& network, const std::vector<int>& points) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(points.size(), kShown); ++i) {
    const bool last = i > 0 && i + 1 == points.size();
    text += (i == 0 ? "" : last ? " and " : ", ") + network.points[static_cast<std::size_t>(points[i])].name;
  }
  if (points.size() > kShown) text += " and " + std::to_string(points.size() - kShown) + " more";
  return text;
}

std::vector<NetworkDefect> CheckNetwork(const Network& network) {
  std::vector<NetworkDefect> defects;
  const std::vector<Conditions> conditions = CountConditions(network);
  Components components(network);
  std::map<int, std::vector<int>> members;
  std::map<int, bool> has_footing;
  bool any_footing = false;
  std::vector<int> unobserved;
  for (int i = 0; i < static_cast<int>(network.points.size()); ++i) {
    const NetworkPoint& point = network.points[static_cast<std::size_t>(i)];
    if (!InUse(point)) continue;
    any_footing = any_footing || HasFooting(point);
    const Conditions& of_point = conditions[static_cast<std::size_t>(i)];
    if (of_point.last.empty()) {
      if (IsAdjusted(point)) unobserved.push_back(i);
      continue;
    }
    members[components.Of(i)].push_back(i);
    has_footing[components.Of(i)] = has_footing[components.Of(i)] || HasFooting(point);
  }
  if (!unobserved.empty()) {
    defects.push_back({unobserved, "no observation leads to " + ListedNames(network, unobserved)});
  }
  for (const auto& [root, points] : members) {
    const bool observed_absolutely =
        std::any_of(network.observations.begin(), network.observations.end(), [&, &root = root](const Observation& o) {
          return (o.kind == ObservationKind::kCoordinate || o.kind == ObservationKind::kHeight) &&
                 components.Of(o.from) == root;
        });
    if (any_footing && !has_footing[root] && !observed_absolutely) {
      defects.push_back({points, ListedNames(network, points) + (points.size() == 1 ? " is" : " are") +
                                     " not connected with the fixed or constrained points"});
      continue;
    }
    for (const int i : points) {
      const NetworkPoint& point = network.points[static_cast<std::size_t>(i)];
      const Conditions& of_point = conditions[static_cast<std::size_t>(i)];
      if (point.IsUnknown(0) && of_point.plane < 2) {
        defects.push_back({{i},
                           "point " + point.name + " is observed from one side only (" +
                               (of_point.plane == 0 ? "nothing fixes its position; " : "") + of_point.last +
                               "): its position is not determined"});
      } else if (point.IsUnknown(2) && of_point.height < 1) {
        defects.push_back({{i}, "point " + point.name + ": no observation determines its height"});
      }
    }
  }
  return defects;
}

Network Without(const Network& network, const std::vector<bool>& points, const std::vector<bool>& observations) {
  Network rest = network;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i]) rest.points[i].plane = rest.points[i].height = CoordinateUse::kUnused;
  }
  const auto goes = [&](std::size_t k) {
    const Observation& o = network.observations[k];
    const auto out = [&](int point) { return point >= 0 && points[static_cast<std::size_t>(point)]; };
    return observations[k] || out(o.from) || out(o.to) || out(o.fore);
  };
  rest.observations.clear();
  rest.correlated.clear();
  rest.num_sets = 0;
  std::map<int, int> sets;
  auto group = network.correlated.begin();
  for (std::size_t k = 0; k < network.observations.size();) {
    const bool correlated = group != network.correlated.end() && group->first == k;
    const std::size_t end = k + (correlated ? static_cast<std::size_t>(group->covariance.rows()) : 1);
    const std::size_t first = k, first_kept = rest.observations.size();
    std::vector<Eigen::Index> kept;
    for (; k < end; ++k) {
      if (goes(k)) continue;
      Observation o = network.observations[k];
      if (o.set >= 0) {
        const auto [found, is_new] = sets.emplace(o.set, rest.num_sets);
        if (is_new) ++rest.num_sets;
        o.set = found->second;
      }
      rest.observations.push_back(o);
      kept.push_back(static_cast<Eigen::Index>(k - first));
    }
    if (!correlated) continue;
    if (!kept.empty()) rest.correlated.push_back({first_kept, Eigen::MatrixXd(group->covariance(kept, kept))});
    ++group;
  }
  return rest;
}

}  // namespace survey
