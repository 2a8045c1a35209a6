// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/control_tests.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "survey/geometry/principal_axes.h"
#include "survey/stats/mahalanobis.h"

namespace survey {
namespace {

using Eigen::Index;

constexpr double kUncontrolled = 1e-9;  // redundancy below which nothing controls a direction

std::vector<Index> RowsOf(const std::vector<int>& marks) {
  std::vector<Index> rows;
  for (const int mark : marks) {
    rows.push_back(2 * mark);
    rows.push_back(2 * mark + 1);
  }
  return rows;
}

}  // namespace

ControlTests::ControlTests(const ControlMisfit& misfit, std::vector<int> kept)
    : misfit_(misfit), kept_(std::move(kept)) {
  const std::vector<Index> rows = RowsOf(kept_);
  misfit_of_kept_ = misfit.misfit(rows);
  own_covariance_ = misfit.of_marks(rows, rows) + misfit.of_control(rows, rows);
  if (kept_.size() < 2) return;
  const Eigen::LLT<Eigen::MatrixXd> factor(misfit.of_network(rows, rows) + own_covariance_);
  if (factor.info() != Eigen::Success) return;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> datum = misfit.datum(rows, Eigen::all);
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(factor.rows(), factor.rows()));
  const Eigen::Matrix<double, Eigen::Dynamic, 3> weighted_datum = inverse * datum;
  const Eigen::LLT<Eigen::Matrix3d> normal(datum.transpose() * weighted_datum);
  if (normal.info() != Eigen::Success) return;
  datum_by_misfit_ = normal.solve(weighted_datum.transpose());
  weight_ = inverse - weighted_datum * datum_by_misfit_;
  weighted_ = weight_ * misfit_of_kept_;
  usable_ = true;
}

Index ControlTests::RowOf(int mark) const {
  return 2 * (std::lower_bound(kept_.begin(), kept_.end(), mark) - kept_.begin());
}

ErrorTest ControlTests::Test(std::span<const int> marks, const TestLevel& level) const {
  Eigen::Vector2d k = Eigen::Vector2d::Zero();
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d own_weight = Eigen::Matrix2d::Zero();
  for (const int a : marks) {
    const Index row = RowOf(a);
    k += weighted_.segment<2>(row);
    own_weight += own_covariance_.block<2, 2>(row, row).inverse();
    for (const int b : marks) matrix += weight_.block<2, 2>(row, RowOf(b));
  }
  const PrincipalAxes principal = PrincipalAxesOf(matrix);
  ErrorTest test;
  test.degrees_of_freedom = 0;
  for (const int axis : {0, 1}) {
    if (principal.values[axis] <= kUncontrolled * own_weight.trace()) continue;
    ++test.degrees_of_freedom;
    const double along = principal.axes.col(axis).dot(k);
    test.t += along * along / principal.values[axis];
  }
  if (test.degrees_of_freedom < 2) return test;
  test.covariance = matrix.inverse();
  test.error = test.covariance * k;
  test.minimal_detectable = MinimalDetectableBias(principal.values[0], NonCentrality(level, 2));
  test.worst_direction = principal.axes.col(0);
  return test;
}

double ControlTests::RedundancyOf(int mark) const {
  const Index row = RowOf(mark);
  return (own_covariance_.block<2, 2>(row, row) * weight_.block<2, 2>(row, row)).trace() / 2.0;
}

ControlTests::Exchange ControlTests::IfExchanged(int a, int b) const {
  const Index row_a = RowOf(a);
  const Index row_b = RowOf(b);
  const Eigen::Vector2d change =
      misfit_.given[static_cast<std::size_t>(b)] - misfit_.given[static_cast<std::size_t>(a)];
  const auto aa = weight_.block<2, 2>(row_a, row_a);
  const auto ab = weight_.block<2, 2>(row_a, row_b);
  const auto bb = weight_.block<2, 2>(row_b, row_b);
  const Eigen::Vector2d k_a = weighted_.segment<2>(row_a) + (aa - ab) * change;
  const Eigen::Vector2d k_b = weighted_.segment<2>(row_b) + (ab.transpose() - bb) * change;
  Exchange exchange;
  exchange.chi_square = chi_square() + 2.0 * change.dot(weighted_.segment<2>(row_a) - weighted_.segment<2>(row_b)) +
                        change.dot((aa - ab - ab.transpose() + bb) * change);
  exchange.t_a = SquaredMahalanobis(k_a, aa);
  exchange.t_b = SquaredMahalanobis(k_b, bb);
  return exchange;
}

double ControlTests::LargestShift(int mark, const Eigen::Vector2d& error) const {
  const Index row = RowOf(mark);
  const Eigen::Vector3d datum = datum_by_misfit_.middleCols<2>(row) * error;
  const Eigen::VectorXd pull = weight_.middleCols<2>(row) * error;
  const Eigen::VectorXd shift =
      misfit_.datum_of_poses * datum + misfit_.poses_with_marks(Eigen::all, RowsOf(kept_)) * pull;
  double largest = 0.0;
  for (Index i = 0; i < shift.size(); i += 2) largest = std::max(largest, shift.segment<2>(i).norm());
  return largest;
}

ControlTests::Scale ControlTests::EstimateScale() const {
  const Eigen::VectorXd by_scale = misfit_.from_centre(RowsOf(kept_));
  const double weight = by_scale.dot(weight_ * by_scale);
  if (!(weight > 0.0)) return {};
  return {by_scale.dot(weighted_) / weight, 1.0 / std::sqrt(weight)};
}

ControlTests::Component ControlTests::ComponentOf(const Eigen::MatrixXd& covariance) const {
  return {weighted_.dot(covariance * weighted_), (covariance * weight_).trace()};
}

ControlTests::Component ControlTests::ComponentOfNetwork() const {
  const std::vector<Index> rows = RowsOf(kept_);
  return ComponentOf(misfit_.of_network(rows, rows));
}

}  // namespace survey
