// SPDX-License-Identifier: Apache-2.0
//
// Points whose places relative to each other are known, growing point by point as a surveyor computes by hand: polar
// points, intersections of rays and of distances, resections, free stations.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "survey/network/sights.h"

namespace survey {

class PlanePiece {
 public:
  // `sights` must outlive the piece. Without `metric` lengths play no part: the scale is open.
  PlanePiece(const Sights& sights, bool metric, bool has_north);

  void Set(int point, const Eigen::Vector2d& position);
  bool Knows(int point) const { return known_[static_cast<std::size_t>(point)]; }
  const Eigen::Vector2d& At(int point) const { return positions_[static_cast<std::size_t>(point)]; }
  int size() const { return size_; }
  bool metric() const { return metric_; }
  const std::vector<int>& points() const { return points_; }

  // Adds all points that can be computed; true when there were any.
  bool Grow();

  // Takes over the points of another piece that shares at least two with this one, by a similarity transformation
  // (rigid when the other is metric). False when they do not overlap enough.
  bool Attach(const PlanePiece& other);

 private:
  std::optional<double> Orientation(const Bundle& bundle) const;
  std::optional<Eigen::Vector2d> Locate(int point) const;
  std::optional<Eigen::Vector2d> ByShift(int point) const;
  std::optional<Eigen::Vector2d> ByPolar(int point) const;
  std::optional<Eigen::Vector2d> ByFreeStation(int point) const;
  std::optional<Eigen::Vector2d> ByIntersection(int point) const;
  std::optional<Eigen::Vector2d> ByResection(int point) const;
  std::optional<Eigen::Vector2d> ByLengths(int point) const;
  double Misfit(int point, const Eigen::Vector2d& candidate) const;

  const Sights* sights_;
  bool metric_;
  bool has_north_;  // azimuths can be used
  std::vector<bool> known_;
  std::vector<Eigen::Vector2d> positions_;
  std::vector<int> points_;
  int size_ = 0;
};

}  // namespace survey
