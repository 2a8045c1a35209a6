// SPDX-License-Identifier: Apache-2.0
#include "survey/network/nonlinear_solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <utility>

namespace survey {
namespace {

constexpr int kMaxIterations = 200;

// Carries the unknowns' corrections into coordinates once for all residuals.
class Corrections : public ceres::EvaluationCallback {
 public:
  Corrections(const Unknowns& unknowns, NetworkState start)
      : unknowns_(unknowns), start_(std::move(start)), values_(Eigen::VectorXd::Zero(unknowns.size())) {}

  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_point) override {
    if (!new_point) return;
    state_ = start_;
    state_.Add(values_, unknowns_);
  }
  double* Of(int unknown) { return &values_[unknown]; }
  const NetworkState& state() const { return state_; }
  NetworkState Final() {
    PrepareForEvaluation(false, true);
    return state_;
  }

 private:
  const Unknowns& unknowns_;
  NetworkState start_;
  NetworkState state_;
  Eigen::VectorXd values_;
};

class GroupCost : public ceres::CostFunction {
 public:
  GroupCost(const Network& network, const ObservationGroup& group, const Unknowns& unknowns,
            const std::vector<int>& involved, const Corrections& corrections)
      : network_(network), group_(group), unknowns_(unknowns), involved_(involved), corrections_(corrections) {
    set_num_residuals(static_cast<int>(group.size));
    mutable_parameter_block_sizes()->assign(involved.size(), 1);
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals, double** jacobians) const override {
    const EquationGroup equations = Linearise(network_, group_, corrections_.state(), unknowns_);
    const auto rows = static_cast<Eigen::Index>(group_.size);
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = -equations.misclosure;
    if (!equations.misclosure.allFinite() || !equations.jacobian.allFinite()) return false;
    if (jacobians == nullptr) return true;
    for (std::size_t k = 0; k < involved_.size(); ++k) {
      if (jacobians[k] == nullptr) continue;
      // A derivative that happens to be zero at this place is not among the equations.
      const auto found = std::lower_bound(equations.unknowns.begin(), equations.unknowns.end(), involved_[k]);
      Eigen::Map<Eigen::VectorXd> column(jacobians[k], rows);
      if (found != equations.unknowns.end() && *found == involved_[k]) {
        column = equations.jacobian.col(found - equations.unknowns.begin());
      } else {
        column.setZero();
      }
    }
    return true;
  }

 private:
  const Network& network_;
  const ObservationGroup& group_;
  const Unknowns& unknowns_;
  std::vector<int> involved_;
  const Corrections& corrections_;
};

// All unknowns that the group's observations may depend on.
std::vector<int> Involved(const Network& network, const ObservationGroup& group, const Unknowns& unknowns) {
  std::vector<int> involved;
  for (std::size_t k = group.first; k < group.first + group.size; ++k) {
    const Observation& observation = network.observations[k];
    for (const int point : {observation.from, observation.to, observation.fore}) {
      for (int component = 0; point >= 0 && component < 3; ++component) {
        involved.push_back(unknowns.Coordinate(point, component));
      }
    }
    if (observation.set >= 0) involved.push_back(unknowns.Orientation(observation.set));
  }
  std::sort(involved.begin(), involved.end());
  involved.erase(std::unique(involved.begin(), involved.end()), involved.end());
  if (!involved.empty() && involved.front() < 0) involved.erase(involved.begin());
  return involved;
}

}  // namespace

NonlinearSummary SolveNonlinear(const Network& network, const std::vector<ObservationGroup>& groups,
                                const Unknowns& unknowns, const std::vector<int>& held, NetworkState* state) {
  Corrections corrections(unknowns, *state);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &corrections;
  ceres::Problem problem(problem_options);
  for (int k = 0; k < unknowns.size(); ++k) problem.AddParameterBlock(corrections.Of(k), 1);
  for (const int k : held) problem.SetParameterBlockConstant(corrections.Of(k));
  for (const ObservationGroup& group : groups) {
    const std::vector<int> involved = Involved(network, group, unknowns);
    if (involved.empty()) continue;
    std::vector<double*> blocks;
    for (const int k : involved) blocks.push_back(corrections.Of(k));
    problem.AddResidualBlock(new GroupCost(network, group, unknowns, involved, corrections), nullptr, blocks);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // the same bytes whatever the number of threads
  options.max_num_iterations = kMaxIterations;
  options.initial_trust_region_radius = 1e8;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 0.0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  *state = corrections.Final();
  return {.usable = summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE,
          .iterations = static_cast<int>(summary.iterations.size()) - 1,
          .message = summary.message};
}

}  // namespace survey
