// SPDX-License-Identifier: Apache-2.0
#include "survey/control/block_extract.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <set>

namespace survey {
namespace {

std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool same =
          std::tolower(static_cast<unsigned char>(a[i])) == std::tolower(static_cast<unsigned char>(b[j]));
      const std::size_t replaced = diagonal + (same ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

const ControlPoint* FindPoint(const ControlNetwork& network, const std::string& name) {
  const auto found = std::find_if(network.points.begin(), network.points.end(),
                                  [&](const ControlPoint& point) { return point.name == name; });
  return found == network.points.end() ? nullptr : &*found;
}

ControlNetwork ExtractOfBlock(const ControlNetwork& network, const std::vector<std::string>& marked) {
  const std::set<std::string> names(marked.begin(), marked.end());
  ControlNetwork extract{.frame = network.frame};
  std::vector<int> place(network.points.size(), -1);  // in the extract
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    const ControlPoint& point = network.points[i];
    const bool usable = point.role == PointRole::kControl || point.role == PointRole::kTie;
    if (!usable || !names.contains(point.name)) continue;
    place[i] = static_cast<int>(extract.points.size());
    extract.points.push_back(point);
  }
  for (PointCorrelation pair : network.correlations) {
    pair.a = place[static_cast<std::size_t>(pair.a)];
    pair.b = place[static_cast<std::size_t>(pair.b)];
    if (pair.a >= 0 && pair.b >= 0) extract.correlations.push_back(pair);
  }
  return extract;
}

void AddPoints(const std::vector<ControlPoint>& points, ControlNetwork* network) {
  if (points.empty()) return;
  std::vector<std::string> names;
  for (const ControlPoint& point : network->points) names.push_back(point.name);
  network->points.insert(network->points.end(), points.begin(), points.end());
  std::sort(network->points.begin(), network->points.end(),
            [](const ControlPoint& a, const ControlPoint& b) { return a.name < b.name; });
  const auto place_of = [&](int before) {
    const auto found =
        std::lower_bound(network->points.begin(), network->points.end(), names[static_cast<std::size_t>(before)],
                         [](const ControlPoint& point, const std::string& name) { return point.name < name; });
    return static_cast<int>(found - network->points.begin());
  };
  for (PointCorrelation& pair : network->correlations) {
    pair.a = place_of(pair.a);
    pair.b = place_of(pair.b);
  }
}

std::vector<std::pair<std::string, std::string>> ChecksOnControl(const ControlNetwork& network, double distance_m) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const ControlPoint& check : network.points) {
    if (check.role != PointRole::kCheck) continue;
    for (const ControlPoint& control : network.points) {
      if (control.role != PointRole::kControl) continue;
      if ((check.position_in_site - control.position_in_site).norm() < distance_m) {
        pairs.emplace_back(check.name, control.name);
      }
    }
  }
  return pairs;
}

std::vector<std::string> SimilarNames(const ControlNetwork& network, const std::string& name, std::size_t count) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const ControlPoint& point : network.points) {
    const std::size_t distance = EditDistance(point.name, name);
    if (2 * distance < std::max(name.size(), point.name.size()) + 1) ranked.emplace_back(distance, point.name);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::string> names;
  for (const auto& [distance, similar] : ranked) {
    if (names.size() < count) names.push_back(similar);
  }
  return names;
}

}  // namespace survey
