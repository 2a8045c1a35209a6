// SPDX-License-Identifier: Apache-2.0
#include "formats/network_cluster.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <set>

#include "formats/control_limits.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"

namespace formats {

using survey::CoordinateUse;
using survey::Observation;
using survey::ObservationKind;

void NetworkClusters::AddPoint(const survey::NetworkPoint& point, const std::string& where) {
  const auto [known, is_new] = index_.emplace(point.name, static_cast<int>(points_.size()));
  if (!is_new) {
    throw DataError(where + "point " + point.name + " is already there (" +
                    point_where_[static_cast<std::size_t>(known->second)] + ")");
  }
  points_.push_back(point);
  RequireAtMost(kMostControlPoints, points_.size(), "points", where);
  std::string first = where;
  while (!first.empty() && (first.back() == ' ' || first.back() == ':')) first.pop_back();
  point_where_.push_back(first);
}

survey::NetworkPoint* NetworkClusters::Point(const std::string& name) {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &points_[static_cast<std::size_t>(found->second)];
}

void NetworkClusters::Begin() { clusters_.emplace_back(); }

void NetworkClusters::Add(NamedObservation observation, const std::string& where) {
  if (clusters_.empty()) clusters_.emplace_back();
  if (observation.from == observation.to || (!observation.fore.empty() && observation.fore == observation.to)) {
    throw DataError(where + "point " + observation.from + " is observed from itself, or twice in one angle");
  }
  clusters_.back().observations.push_back(std::move(observation));
  clusters_.back().where.push_back(where);
  RequireAtMost(kMostObservations, ++num_observations_, "observations", where);
}

void NetworkClusters::SetCovariance(const std::vector<double>& numbers, int size, int band, const std::string& where) {
  Cluster& cluster = clusters_.back();
  if (static_cast<std::size_t>(size) != cluster.observations.size()) {
    throw DataError(where + "the covariance matrix has the dimension " + std::to_string(size) + " for " +
                    std::to_string(cluster.observations.size()) + " observations");
  }
  if (band < 0 || band >= std::max(size, 1)) throw DataError(where + "the band must lie between 0 and dim - 1");
  cluster.covariance.setZero(size, size);
  std::size_t next = 0;
  for (int row = 0; row < size; ++row) {
    for (int column = row; column <= std::min(size - 1, row + band); ++column) {
      if (next == numbers.size()) throw DataError(where + "the covariance matrix has too few numbers");
      const double unit = cluster.observations[static_cast<std::size_t>(row)].covariance_unit *
                          cluster.observations[static_cast<std::size_t>(column)].covariance_unit;
      cluster.covariance(row, column) = cluster.covariance(column, row) = unit * numbers[next++];
    }
  }
  if (next != numbers.size()) throw DataError(where + "the covariance matrix has too many numbers");
  if (cluster.covariance.llt().info() != Eigen::Success) {
    throw DataError(where + "the covariance matrix is not positive definite");
  }
}

void NetworkClusters::End() {
  Cluster& cluster = clusters_.back();
  for (std::size_t i = 0; i < cluster.observations.size(); ++i) {
    Observation& o = cluster.observations[i].observation;
    const auto row = static_cast<Eigen::Index>(i);
    if (cluster.covariance.size() > 0) o.sigma = std::sqrt(cluster.covariance(row, row));
    if (o.sigma > 0.0) continue;
    throw DataError(cluster.where[i] + "the " + std::string(survey::Name(o.kind)) +
                    " has no standard deviation, by itself, by default or in a covariance matrix");
  }
}

// Indices of the points; false when one is missing or lacks the coordinates that the observation needs.
bool NetworkClusters::Resolve(NamedObservation* named) const {
  Observation& o = named->observation;
  const bool height_only =
      o.kind == ObservationKind::kHeightDifference || o.kind == ObservationKind::kHeight ||
      ((o.kind == ObservationKind::kCoordinate || o.kind == ObservationKind::kDifference) && o.component == 2);
  const bool with_height =
      height_only || o.kind == ObservationKind::kSlopeDistance || o.kind == ObservationKind::kZenithAngle;
  const auto find = [&](const std::string& name, int* index) {
    if (name.empty()) return true;
    const auto found = index_.find(name);
    if (found == index_.end()) return false;
    *index = found->second;
    const survey::NetworkPoint& point = points_[static_cast<std::size_t>(*index)];
    return (height_only || point.plane != CoordinateUse::kUnused) &&
           (!with_height || point.height != CoordinateUse::kUnused);
  };
  return find(named->from, &o.from) && find(named->to, &o.to) && find(named->fore, &o.fore);
}

void NetworkClusters::AddCluster(Cluster& cluster, survey::Network* network, std::vector<std::string>* left_out) const {
  std::vector<Eigen::Index> kept;
  const std::size_t first = network->observations.size();
  int set = -1;
  for (std::size_t i = 0; i < cluster.observations.size(); ++i) {
    NamedObservation& named = cluster.observations[i];
    if (!Resolve(&named)) {
      left_out->push_back(cluster.where[i] + std::string(survey::Name(named.observation.kind)) + " " + named.from +
                          (named.to.empty() ? "" : " - " + named.to) + (named.fore.empty() ? "" : " - " + named.fore));
      continue;
    }
    if (named.observation.kind == ObservationKind::kDirection) {
      if (set < 0) set = network->num_sets++;
      named.observation.set = set;
    }
    kept.push_back(static_cast<Eigen::Index>(i));
    network->observations.push_back(named.observation);
  }
  if (kept.empty() || cluster.covariance.size() == 0) return;
  const Eigen::MatrixXd covariance = cluster.covariance(kept, kept);
  if (covariance.isDiagonal(0.0)) return;
  network->correlated.push_back({.first = first, .covariance = covariance});
}

void NetworkClusters::MoveInto(survey::Network* network, std::vector<std::string>* warnings) {
  network->points = points_;
  std::vector<std::string> left_out;
  for (Cluster& cluster : clusters_) AddCluster(cluster, network, &left_out);
  if (left_out.empty()) return;
  warnings->push_back(left_out.front() +
                      (left_out.size() > 1 ? " and " + std::to_string(left_out.size() - 1) + " more" : "") +
                      ": left out, since a point is not listed, or is not adjusted in these coordinates");
}

}  // namespace formats
