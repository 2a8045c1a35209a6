// SPDX-License-Identifier: Apache-2.0
//
// What the sensors alone say about the marks on control points, against the given coordinates. The free network (no
// control, one pose held) predicts the places of the marks with their full covariance; a rigid motion of three
// parameters is free between both. All tests of control need no more than this: with n marks 2n - 3 conditions that
// hold the blunders and nothing of the network's inside. One Gauss-Newton step from the graph's poses.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "survey/graph/pose_graph.h"

namespace survey {

// Rows: x, y (m) of each mark in order.
struct ControlMisfit {
  std::vector<int> marks;                          // indices of the graph's marks on points with given coordinates
  std::vector<int> points;                         // the graph's point of each
  std::vector<Eigen::Vector2d> given;              // its given coordinates
  Eigen::VectorXd misfit;                          // given minus predicted
  Eigen::MatrixXd of_network;                      // covariance of the predicted places by the network, m2
  Eigen::MatrixXd of_marks;                        // by the centring of each mark
  Eigen::MatrixXd of_control;                      // covariance of the given coordinates
  Eigen::Matrix<double, Eigen::Dynamic, 3> datum;  // places by the rigid motion: x, y (m), rotation about the centre
  Eigen::VectorXd from_centre;                     // places from the marks' centre: derivative by a scale

  // Of all poses (x, y in m), for the effect of an error on the map.
  Eigen::MatrixXd poses_with_marks;  // covariance with the predicted places
  Eigen::Matrix<double, Eigen::Dynamic, 3> datum_of_poses;

  int size() const { return static_cast<int>(marks.size()); }
};

// `given`: of all control points, whether the graph uses them or not. Empty when the free network is singular.
std::optional<ControlMisfit> MisfitOfControl(const PoseGraph& graph, const std::vector<GivenCoordinates>& given);

}  // namespace survey
