// SPDX-License-Identifier: Apache-2.0
#include "survey/network/datum.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>

namespace survey {
namespace {

constexpr double kUnseen = 1e-12;   // squared effect of a motion on the observations, relative to their sensitivity
constexpr double kNoMotion = 1e-8;  // squared size of a motion
constexpr std::array<const char*, 7> kMotions = {
    "shift in x", "shift in y", "shift in height", "rotation", "tilt about x", "tilt about y", "scale"};

struct Extent {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double size = 0.0;
};

// Of the coordinates in use.
Extent ExtentOf(const Network& network, const NetworkState& state) {
  Extent extent;
  for (int component = 0; component < 3; ++component) {
    double low = 0.0, high = 0.0;
    bool first = true;
    for (std::size_t i = 0; i < network.points.size(); ++i) {
      if (network.points[i].Use(component) == CoordinateUse::kUnused) continue;
      const double value = state.positions[i][component];
      low = first ? value : std::min(low, value);
      high = first ? value : std::max(high, value);
      first = false;
    }
    extent.centre[component] = (low + high) / 2.0;
    extent.size = std::max(extent.size, (high - low) / 2.0);
  }
  if (extent.size == 0.0) extent.size = 1.0;
  return extent;
}

// The seven motions of all coordinates and orientations, also of fixed ones, as columns; rows: three for each point,
// then the sets.
Eigen::MatrixXd Motions(const Network& network, const NetworkState& state) {
  const auto num_points = static_cast<Eigen::Index>(state.positions.size());
  const auto num_sets = static_cast<Eigen::Index>(state.orientations.size());
  const Extent extent = ExtentOf(network, state);
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * num_points + num_sets, 7);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const Eigen::Vector3d p = (state.positions[static_cast<std::size_t>(i)] - extent.centre) / extent.size;
    motions.block<3, 3>(3 * i, 0).setIdentity();
    motions.block<3, 1>(3 * i, 3) = Eigen::Vector3d(-p.y(), p.x(), 0.0);
    motions.block<3, 1>(3 * i, 4) = Eigen::Vector3d(0.0, -p.z(), p.y());
    motions.block<3, 1>(3 * i, 5) = Eigen::Vector3d(p.z(), 0.0, -p.x());
    motions.block<3, 1>(3 * i, 6) = p;
  }
  // A turn of the network to the left makes all azimuths, and with them the orientations, smaller.
  motions.block(3 * num_points, 3, num_sets, 1).setConstant(-1.0 / extent.size);
  return motions;
}

// Rows of the motions that are unknowns, in their order.
Eigen::MatrixXd OfUnknowns(const Eigen::MatrixXd& motions, const Unknowns& unknowns, Eigen::Index num_points) {
  Eigen::MatrixXd rows(unknowns.size(), motions.cols());
  for (int k = 0; k < unknowns.size(); ++k) {
    const Unknowns::Owner owner = unknowns.OwnerOf(k);
    rows.row(k) = motions.row(owner.point < 0 ? 3 * num_points + owner.component : 3 * owner.point + owner.component);
  }
  return rows;
}

// Sum over the observations of the squared effect of motions on them, as a 7 x 7 form.
Eigen::MatrixXd SeenByObservations(const LinearSystem& system, const Eigen::MatrixXd& motions) {
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(motions.cols(), motions.cols());
  Eigen::MatrixXd rows;
  for (const EquationGroup& group : system.groups) {
    rows.resize(static_cast<Eigen::Index>(group.unknowns.size()), motions.cols());
    for (std::size_t k = 0; k < group.unknowns.size(); ++k) {
      rows.row(static_cast<Eigen::Index>(k)) = motions.row(group.unknowns[k]);
    }
    const Eigen::MatrixXd effect = group.jacobian * rows;
    // Effects of single observations relative to their own sensitivity: precise and rough observations count alike.
    for (Eigen::Index i = 0; i < effect.rows(); ++i) {
      const double sensitivity = group.jacobian.row(i).norm() * rows.norm();
      if (sensitivity > 0.0) form += effect.row(i).transpose() * effect.row(i) / (sensitivity * sensitivity);
    }
  }
  return form;
}

// How far motions move fixed coordinates.
Eigen::MatrixXd SeenByFixed(const Network& network, const Eigen::MatrixXd& motions) {
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(motions.cols(), motions.cols());
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    for (int component = 0; component < 3; ++component) {
      if (network.points[i].Use(component) != CoordinateUse::kFixed) continue;
      const auto row = motions.row(3 * static_cast<Eigen::Index>(i) + component);
      form += row.transpose() * row;
    }
  }
  return form;
}

std::vector<std::string> Words(const Eigen::MatrixXd& combinations) {
  std::vector<std::string> words;
  for (Eigen::Index k = 0; k < combinations.rows(); ++k) {
    if (combinations.cols() > 0 && combinations.row(k).norm() > 0.1) {
      words.emplace_back(kMotions[static_cast<std::size_t>(k)]);
    }
  }
  return words;
}

// Motions that leave all unknowns where they are (heights in a plane network) are no defect: their columns go.
Eigen::MatrixXd Independent(const Eigen::MatrixXd& basis, Eigen::MatrixXd* combinations) {
  if (basis.cols() == 0) return basis;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(basis.transpose() * basis);
  const Eigen::VectorXd& sizes = eigen.eigenvalues();
  const Eigen::Index rank = (sizes.array() > kNoMotion * std::max(1.0, sizes.maxCoeff())).count();
  *combinations = *combinations * eigen.eigenvectors().rightCols(rank);
  return basis * eigen.eigenvectors().rightCols(rank);
}

}  // namespace

Datum FindDatum(const Network& network, const NetworkState& state, const Unknowns& unknowns,
                const LinearSystem& system) {
  Datum datum;
  datum.defines.resize(static_cast<std::size_t>(unknowns.size()), false);
  for (int k = 0; k < unknowns.num_coordinates(); ++k) {
    const Unknowns::Owner owner = unknowns.OwnerOf(k);
    datum.defines[static_cast<std::size_t>(k)] =
        network.points[static_cast<std::size_t>(owner.point)].Use(owner.component) == CoordinateUse::kConstrained;
  }
  const Eigen::MatrixXd motions = Motions(network, state);
  const Eigen::MatrixXd of_unknowns = OfUnknowns(motions, unknowns, static_cast<Eigen::Index>(network.points.size()));
  const Eigen::MatrixXd seen = SeenByObservations(system, of_unknowns) + SeenByFixed(network, motions);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(seen);
  const double largest = std::max(eigen.eigenvalues().maxCoeff(), 1.0);
  Eigen::Index open = 0;
  while (open < 7 && eigen.eigenvalues()[open] < kUnseen * largest) ++open;
  Eigen::MatrixXd combinations = eigen.eigenvectors().leftCols(open);
  datum.basis = Independent(of_unknowns * combinations, &combinations);
  datum.open = Words(combinations);

  Eigen::MatrixXd settled = datum.basis;
  for (int k = 0; k < unknowns.size(); ++k) {
    if (!datum.defines[static_cast<std::size_t>(k)]) settled.row(k).setZero();
  }
  if (datum.defect() == 0) return datum;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> by_constraints(settled.transpose() * settled);
  Eigen::Index loose = 0;
  while (loose < datum.basis.cols() && by_constraints.eigenvalues()[loose] < kNoMotion) ++loose;
  datum.not_settled = Words(combinations * by_constraints.eigenvectors().leftCols(loose));
  return datum;
}

DatumTransformation::DatumTransformation(const Datum& datum) : basis_(datum.basis) {
  selector_ = basis_;
  for (Eigen::Index k = 0; k < selector_.rows(); ++k) {
    if (!datum.defines[static_cast<std::size_t>(k)]) selector_.row(k).setZero();
  }
  if (basis_.cols() == 0) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> common(selector_.transpose() * basis_);
  const Eigen::MatrixXd& axes = common.eigenvectors();
  selector_ = selector_ * (axes * common.eigenvalues().cwiseInverse().asDiagonal() * axes.transpose());
}

Eigen::VectorXd DatumTransformation::operator()(const Eigen::VectorXd& x) const {
  return basis_.cols() == 0 ? x : Eigen::VectorXd(x - basis_ * (selector_.transpose() * x));
}

std::vector<int> HeldUnknowns(const Datum& datum) {
  std::vector<int> held;
  if (datum.defect() == 0) return held;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> pivots(datum.basis.transpose());
  for (int k = 0; k < datum.defect(); ++k) held.push_back(pivots.colsPermutation().indices()[k]);
  return held;
}

}  // namespace survey
