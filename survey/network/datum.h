// SPDX-License-Identifier: Apache-2.0
//
// What the observations leave open: shifts, rotations and the scale of the whole network. The columns of a datum basis
// are small motions of all unknowns that change no observation and no fixed coordinate; the constrained coordinates
// must settle them (inner constraints: of all solutions the one with the smallest shifts of the constrained
// coordinates).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "survey/network/linear_system.h"

namespace survey {

struct Datum {
  Eigen::MatrixXd basis;                 // unknowns x defect, columns in no particular scale
  std::vector<bool> defines;             // by unknown: a constrained coordinate
  std::vector<std::string> open;         // what is open, in words: "shift in x", "rotation", "scale"
  std::vector<std::string> not_settled;  // of these, what the constrained coordinates do not settle either

  int defect() const { return static_cast<int>(basis.cols()); }
};

Datum FindDatum(const Network& network, const NetworkState& state, const Unknowns& unknowns,
                const LinearSystem& system);

// The datum transformation x -> S x with S = I - G (G'EG)^-1 G'E (G the basis, E the defining coordinates), which turns
// any solution of the normal equations into that of the inner constraints, and its cofactors likewise.
class DatumTransformation {
 public:
  explicit DatumTransformation(const Datum& datum);

  Eigen::VectorXd operator()(const Eigen::VectorXd& x) const;
  const Eigen::MatrixXd& basis() const { return basis_; }
  const Eigen::MatrixXd& selector() const { return selector_; }  // A = (G'EG)^-1 G'E, transposed

 private:
  Eigen::MatrixXd basis_;
  Eigen::MatrixXd selector_;
};

// As many unknowns as the defect, which may be held to make the normal equations regular; the choice changes nothing in
// the result.
std::vector<int> HeldUnknowns(const Datum& datum);

}  // namespace survey
