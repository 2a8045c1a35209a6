// SPDX-License-Identifier: Apache-2.0
//
// The network's observation equations, linearised and whitened: uncorrelated observations one by one, correlated ones
// together. With L L' = covariance of the group, A = d computed / d unknowns: jacobian = L^-1 A and
// misclosure = L^-1 (observed - computed), so that a correction x of the unknowns has the weighted square sum
// |jacobian x - misclosure|2.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "survey/network/network.h"

namespace survey {

// Numbers of the unknowns: adjusted coordinates point by point, then the orientations of the sets.
class Unknowns {
 public:
  explicit Unknowns(const Network& network);

  int Coordinate(int point, int component) const {  // -1: not unknown
    return coordinates_[3 * static_cast<std::size_t>(point) + static_cast<std::size_t>(component)];
  }
  int Orientation(int set) const { return num_coordinates_ + set; }
  int num_coordinates() const { return num_coordinates_; }
  int size() const { return size_; }
  // Whose coordinate an unknown is; point -1 and component = set for an orientation.
  struct Owner {
    int point = -1;
    int component = 0;
  };
  Owner OwnerOf(int unknown) const;

 private:
  std::vector<int> coordinates_;
  std::vector<Owner> owners_;
  int num_coordinates_ = 0;
  int size_ = 0;
};

// Values of everything that the equations depend on.
struct NetworkState {
  std::vector<Eigen::Vector3d> positions;  // of all points
  std::vector<double> orientations;        // of all sets, rad

  void Add(const Eigen::VectorXd& correction, const Unknowns& unknowns);
};

// Observations [first, first + size) that share a covariance.
struct ObservationGroup {
  std::size_t first = 0;
  std::size_t size = 1;
  Eigen::MatrixXd factor;  // L, lower triangle
};

// In order; precondition: sigmas positive, covariances positive definite.
std::vector<ObservationGroup> GroupsOf(const Network& network);

struct EquationGroup {
  std::vector<int> unknowns;   // that take part, ascending
  Eigen::MatrixXd jacobian;    // a column for each of them
  Eigen::VectorXd misclosure;  // one for each observation
};

EquationGroup Linearise(const Network& network, const ObservationGroup& group, const NetworkState& state,
                        const Unknowns& unknowns);

struct LinearSystem {
  std::vector<EquationGroup> groups;
  int num_unknowns = 0;
  int num_observations = 0;

  Eigen::SparseMatrix<double> NormalMatrix() const;  // J'J
  Eigen::VectorXd RightSide() const;                 // J' misclosure
  double SquareSum() const;                          // of the misclosures
  Eigen::MatrixXd DenseJacobian() const;
  Eigen::VectorXd Misclosures() const;
};

LinearSystem Linearise(const Network& network, const std::vector<ObservationGroup>& groups, const NetworkState& state,
                       const Unknowns& unknowns);

}  // namespace survey
