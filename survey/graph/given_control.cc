// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/given_control.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <numeric>

namespace survey {
namespace {

// A control point of the network that the graph knows.
struct KnownPoint {
  const ControlPoint* point = nullptr;
  int in_graph = 0;
};

std::map<int, KnownPoint> KnownPoints(const ControlNetwork& control, const std::vector<std::string>& point_names,
                                      const std::set<std::string>& left_out) {
  std::map<int, KnownPoint> known;  // by index in the network
  for (std::size_t i = 0; i < control.points.size(); ++i) {
    const ControlPoint& point = control.points[i];
    const auto name = std::lower_bound(point_names.begin(), point_names.end(), point.name);
    const bool marked = name != point_names.end() && *name == point.name;
    if (point.role != PointRole::kControl || !marked || left_out.contains(point.name)) continue;
    known[static_cast<int>(i)] = {&point, static_cast<int>(name - point_names.begin())};
  }
  return known;
}

// For each known point the smallest index among all points that chains of covariances join it with.
std::map<int, int> GroupsOf(const std::map<int, KnownPoint>& known, const std::vector<PointCorrelation>& correlations) {
  std::map<int, int> parent;
  for (const auto& [index, point] : known) parent[index] = index;
  const auto root = [&](int index) {
    while (parent.at(index) != index) index = parent.at(index) = parent.at(parent.at(index));
    return index;
  };
  for (const PointCorrelation& pair : correlations) {
    if (!known.contains(pair.a) || !known.contains(pair.b)) continue;
    const auto [low, high] = std::minmax({root(pair.a), root(pair.b)});
    parent[high] = low;
  }
  std::map<int, int> group;
  for (const auto& [index, point] : known) group[index] = root(index);
  return group;
}

bool IsPositiveDefinite(const Eigen::MatrixXd& covariance) {
  constexpr double kSmallest = 1e-10;  // (0.01 mm)^2
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  return factor.info() == Eigen::Success && factor.matrixLLT().diagonal().array().square().minCoeff() > kSmallest;
}

}  // namespace

GivenControl GiveControl(const ControlNetwork& control, const std::vector<std::string>& point_names,
                         const std::set<std::string>& left_out, const Eigen::Vector2d& offset) {
  const std::map<int, KnownPoint> known = KnownPoints(control, point_names, left_out);
  const std::map<int, int> group_of = GroupsOf(known, control.correlations);
  GivenControl result;
  std::map<int, std::size_t> place_of_group;
  std::map<int, Eigen::Index> row_of;  // within its group
  std::map<int, Eigen::Index> size_of_group;
  for (const auto& [index, group] : group_of) row_of[index] = 2 * size_of_group[group]++;
  for (const auto& [group, size] : size_of_group) {
    place_of_group[group] = result.given.size();
    result.given.push_back({{}, Eigen::VectorXd::Zero(2 * size), Eigen::MatrixXd::Zero(2 * size, 2 * size)});
  }
  for (const auto& [index, point] : known) {
    GivenCoordinates& given = result.given[place_of_group.at(group_of.at(index))];
    given.points.push_back(point.in_graph);
    given.coordinates.segment<2>(row_of.at(index)) = point.point->position_in_site - offset;
    given.covariance.block<2, 2>(row_of.at(index), row_of.at(index)) = point.point->covariance;
  }
  for (const PointCorrelation& pair : control.correlations) {
    if (!known.contains(pair.a) || !known.contains(pair.b)) continue;
    Eigen::MatrixXd& covariance = result.given[place_of_group.at(group_of.at(pair.a))].covariance;
    covariance.block<2, 2>(row_of.at(pair.a), row_of.at(pair.b)) = pair.covariance;
    covariance.block<2, 2>(row_of.at(pair.b), row_of.at(pair.a)) = pair.covariance.transpose();
  }
  for (GivenCoordinates& given : result.given) {
    if (IsPositiveDefinite(given.covariance)) continue;
    given.covariance.diagonal().array() += 1e-9;
    if (IsPositiveDefinite(given.covariance) || !result.problem.empty()) continue;
    result.problem = "the covariance of the control points around " +
                     point_names[static_cast<std::size_t>(given.points.front())] + " is not positive definite";
  }
  return result;
}

}  // namespace survey
