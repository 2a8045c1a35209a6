// SPDX-License-Identifier: Apache-2.0
#include "survey/network/linear_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "survey/network/observation_equation.h"

namespace survey {

Unknowns::Unknowns(const Network& network) : coordinates_(3 * network.points.size(), -1) {
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    for (int component = 0; component < 3; ++component) {
      if (!network.points[i].IsUnknown(component)) continue;
      coordinates_[3 * i + static_cast<std::size_t>(component)] = num_coordinates_++;
      owners_.push_back({static_cast<int>(i), component});
    }
  }
  size_ = num_coordinates_ + network.num_sets;
}

Unknowns::Owner Unknowns::OwnerOf(int unknown) const {
  if (unknown >= num_coordinates_) return {-1, unknown - num_coordinates_};
  return owners_[static_cast<std::size_t>(unknown)];
}

void NetworkState::Add(const Eigen::VectorXd& correction, const Unknowns& unknowns) {
  for (int k = 0; k < unknowns.size(); ++k) {
    const Unknowns::Owner owner = unknowns.OwnerOf(k);
    if (owner.point < 0) {
      orientations[static_cast<std::size_t>(owner.component)] += correction[k];
    } else {
      positions[static_cast<std::size_t>(owner.point)][owner.component] += correction[k];
    }
  }
}

std::vector<ObservationGroup> GroupsOf(const Network& network) {
  std::vector<ObservationGroup> groups;
  auto correlated = network.correlated.begin();
  for (std::size_t i = 0; i < network.observations.size();) {
    ObservationGroup group{.first = i};
    if (correlated != network.correlated.end() && correlated->first == i) {
      group.size = static_cast<std::size_t>(correlated->covariance.rows());
      group.factor = correlated->covariance.llt().matrixL();
      ++correlated;
    } else {
      group.factor = Eigen::MatrixXd::Constant(1, 1, network.observations[i].sigma);
    }
    i += group.size;
    groups.push_back(std::move(group));
  }
  return groups;
}

EquationGroup Linearise(const Network& network, const ObservationGroup& group, const NetworkState& state,
                        const Unknowns& unknowns) {
  struct Entry {
    Eigen::Index row;
    int unknown;
    double value;
  };
  std::vector<Entry> entries;
  EquationGroup equations;
  equations.misclosure.resize(static_cast<Eigen::Index>(group.size));
  for (std::size_t k = 0; k < group.size; ++k) {
    const Observation& observation = network.observations[group.first + k];
    const bool in_set = observation.kind == ObservationKind::kDirection;
    const double orientation = in_set ? state.orientations[static_cast<std::size_t>(observation.set)] : 0.0;
    const ObservationEquation equation = Evaluate(observation, state.positions, orientation, network.geometry);
    const auto row = static_cast<Eigen::Index>(k);
    equations.misclosure[row] = Misclosure(observation, equation.computed);
    for (std::size_t p = 0; p < static_cast<std::size_t>(equation.num_points); ++p) {
      for (int component = 0; component < 3; ++component) {
        const int unknown = unknowns.Coordinate(equation.points[p], component);
        const double partial = equation.partials[p][component];
        if (unknown >= 0 && partial != 0.0) entries.push_back({row, unknown, partial});
      }
    }
    if (in_set) entries.push_back({row, unknowns.Orientation(observation.set), equation.orientation_partial});
  }
  for (const Entry& entry : entries) equations.unknowns.push_back(entry.unknown);
  std::sort(equations.unknowns.begin(), equations.unknowns.end());
  equations.unknowns.erase(std::unique(equations.unknowns.begin(), equations.unknowns.end()), equations.unknowns.end());
  equations.jacobian.setZero(static_cast<Eigen::Index>(group.size),
                             static_cast<Eigen::Index>(equations.unknowns.size()));
  for (const Entry& entry : entries) {
    const auto column = std::lower_bound(equations.unknowns.begin(), equations.unknowns.end(), entry.unknown);
    equations.jacobian(entry.row, column - equations.unknowns.begin()) += entry.value;
  }
  const auto lower = group.factor.triangularView<Eigen::Lower>();
  lower.solveInPlace(equations.jacobian);
  lower.solveInPlace(equations.misclosure);
  return equations;
}

LinearSystem Linearise(const Network& network, const std::vector<ObservationGroup>& groups, const NetworkState& state,
                       const Unknowns& unknowns) {
  LinearSystem system{.num_unknowns = unknowns.size(),
                      .num_observations = static_cast<int>(network.observations.size())};
  system.groups.reserve(groups.size());
  for (const ObservationGroup& group : groups) {
    system.groups.push_back(Linearise(network, group, state, unknowns));
  }
  return system;
}

Eigen::SparseMatrix<double> LinearSystem::NormalMatrix() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const EquationGroup& group : groups) {
    const Eigen::MatrixXd normal = group.jacobian.transpose() * group.jacobian;
    for (Eigen::Index i = 0; i < normal.rows(); ++i) {
      for (Eigen::Index j = 0; j < normal.cols(); ++j) {
        entries.emplace_back(group.unknowns[static_cast<std::size_t>(i)], group.unknowns[static_cast<std::size_t>(j)],
                             normal(i, j));
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(num_unknowns, num_unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::VectorXd LinearSystem::RightSide() const {
  Eigen::VectorXd side = Eigen::VectorXd::Zero(num_unknowns);
  for (const EquationGroup& group : groups) {
    const Eigen::VectorXd part = group.jacobian.transpose() * group.misclosure;
    for (Eigen::Index i = 0; i < part.size(); ++i) side[group.unknowns[static_cast<std::size_t>(i)]] += part[i];
  }
  return side;
}

double LinearSystem::SquareSum() const {
  double sum = 0.0;
  for (const EquationGroup& group : groups) sum += group.misclosure.squaredNorm();
  return sum;
}

Eigen::MatrixXd LinearSystem::DenseJacobian() const {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(num_observations, num_unknowns);
  Eigen::Index row = 0;
  for (const EquationGroup& group : groups) {
    for (Eigen::Index column = 0; column < group.jacobian.cols(); ++column) {
      dense.block(row, group.unknowns[static_cast<std::size_t>(column)], group.jacobian.rows(), 1) =
          group.jacobian.col(column);
    }
    row += group.jacobian.rows();
  }
  return dense;
}

Eigen::VectorXd LinearSystem::Misclosures() const {
  Eigen::VectorXd all(num_observations);
  Eigen::Index row = 0;
  for (const EquationGroup& group : groups) {
    all.segment(row, group.misclosure.size()) = group.misclosure;
    row += group.misclosure.size();
  }
  return all;
}

}  // namespace survey
