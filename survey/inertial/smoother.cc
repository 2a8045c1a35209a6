// SPDX-License-Identifier: Apache-2.0
#include "survey/inertial/smoother.h"

#include <Eigen/Cholesky>

namespace survey {
namespace {

// G^T of the gain G = P+(k) Phi^T P-(k+1)^-1, with rows and columns scaled so that metres and rad/s compare.
ErrorMatrix TransposedGain(const ErrorMatrix& updated, const ErrorMatrix& phi, const ErrorMatrix& predicted) {
  const ErrorVector scale = predicted.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const ErrorMatrix scaled = scale.asDiagonal() * predicted * scale.asDiagonal();
  ErrorMatrix crossed;
  crossed.noalias() = phi * updated;
  return scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * crossed);
}

}  // namespace

PackedCovariance::PackedCovariance(const ErrorMatrix& full) {
  std::size_t next = 0;
  for (int column = 0; column < 15; ++column) {
    for (int row = 0; row <= column; ++row) upper_[next++] = full(row, column);
  }
}

ErrorMatrix PackedCovariance::Full() const {
  ErrorMatrix full;
  std::size_t next = 0;
  for (int column = 0; column < 15; ++column) {
    for (int row = 0; row <= column; ++row) full(row, column) = full(column, row) = upper_[next++];
  }
  return full;
}

void Smooth(const FilterSteps& steps,
            const std::function<void(std::size_t, const InertialState&, const ErrorMatrix&)>& visit) {
  InertialState state;
  ErrorMatrix covariance;
  for (std::size_t k = steps.size(); k-- > 0;) {
    const FilterStep& step = steps[k];
    if (k + 1 == steps.size() || !steps[k + 1].continues) {
      state = step.updated;
      covariance = step.updated_covariance.Full();
    } else {
      const FilterStep& next = steps[k + 1];
      const ErrorMatrix updated = step.updated_covariance.Full();
      const ErrorMatrix predicted = next.predicted_covariance.Full();
      const ErrorMatrix gain = TransposedGain(updated, ToMatrix(next.transition), predicted);
      state = Plus(step.updated, gain.transpose() * Minus(state, next.predicted));
      const ErrorMatrix change = covariance - predicted;
      ErrorMatrix half;
      half.noalias() = change * gain;
      covariance = updated;
      covariance.noalias() += gain.transpose() * half;
    }
    visit(k, state, covariance);
  }
}

}  // namespace survey
