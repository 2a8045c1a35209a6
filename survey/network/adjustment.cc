// SPDX-License-Identifier: Apache-2.0
#include "survey/network/adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

#include "survey/accuracy/distributions.h"
#include "survey/network/datum.h"
#include "survey/network/dense_solver.h"
#include "survey/network/nonlinear_solver.h"
#include "survey/network/observation_equation.h"

namespace survey {
namespace {

constexpr int kMaxSteps = 50;
constexpr double kConverged = 1e-8;     // m and rad: a thousandth of the smallest digit of a report
constexpr double kUncontrolled = 1e-7;  // redundancy number of an observation that nothing controls

// Orientations such that the first direction of each set fits.
NetworkState StartOf(const Network& network) {
  NetworkState state;
  for (const NetworkPoint& point : network.points) state.positions.push_back(point.position);
  state.orientations.assign(static_cast<std::size_t>(network.num_sets), 0.0);
  std::vector<bool> known(state.orientations.size(), false);
  for (const Observation& observation : network.observations) {
    if (observation.kind != ObservationKind::kDirection || known[static_cast<std::size_t>(observation.set)]) continue;
    const ObservationEquation equation = Evaluate(observation, state.positions, 0.0, network.geometry);
    state.orientations[static_cast<std::size_t>(observation.set)] = equation.computed - observation.value;
    known[static_cast<std::size_t>(observation.set)] = true;
  }
  return state;
}

std::string Listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string PointsThatMove(const Network& network, const Unknowns& unknowns, const Eigen::VectorXd& motion) {
  double largest = 0.0;
  for (int k = 0; k < unknowns.num_coordinates(); ++k) largest = std::max(largest, std::abs(motion[k]));
  std::vector<std::string> names;
  for (int k = 0; k < unknowns.num_coordinates(); ++k) {
    const std::string& name = network.points[static_cast<std::size_t>(unknowns.OwnerOf(k).point)].name;
    if (std::abs(motion[k]) > 0.05 * largest && (names.empty() || names.back() != name)) names.push_back(name);
  }
  const std::size_t count = names.size();
  if (count > 10) names.resize(10);
  return Listed(names) + (count > 10 ? " and " + std::to_string(count - 10) + " more" : "");
}

class Adjuster {
 public:
  Adjuster(const Network& network, const AdjustmentOptions& options)
      : network_(network), options_(options), result_(network), groups_(GroupsOf(network)), state_(StartOf(network)) {}

  NetworkAdjustment Run() {
    const bool solved = options_.solver == NetworkSolver::kSparse ? SolveSparse() : SolveDenseSystem();
    if (!solved) return std::move(result_);
    Collect();
    result_.usable = true;
    return std::move(result_);
  }

 private:
  bool Fail(const std::string& message) {
    result_.message = message;
    return false;
  }

  LinearSystem System() const { return Linearise(network_, groups_, state_, result_.unknowns); }

  bool SolveSparse() {
    LinearSystem system = System();
    Datum datum = FindDatum(network_, state_, result_.unknowns, system);
    if (!datum.not_settled.empty()) {
      return Fail("the network has no datum: " + Listed(datum.not_settled) +
                  " of the whole network is open; fix coordinates, or constrain them (free network)");
    }
    const std::vector<int> held = HeldUnknowns(datum);
    result_.defect = datum.defect();
    {
      const SparseNormal normal(system.NormalMatrix(), held);
      if (normal.undetermined().size() > 0) return FailSingular(normal.undetermined());
    }
    const NetworkState start = state_;
    const NonlinearSummary summary = SolveNonlinear(network_, groups_, result_.unknowns, held, &state_);
    result_.iterations = summary.iterations;
    // The last steps, which also bring the solution into its datum.
    Eigen::VectorXd shift = Shift(start);
    for (int step = 0; step < kMaxSteps; ++step) {
      system = System();
      if (datum.defect() > 0) datum = FindDatum(network_, state_, result_.unknowns, system);
      if (datum.defect() != result_.defect) return Fail("the network's datum is not stable in the adjustment");
      SparseNormal normal(system.NormalMatrix(), held);
      if (normal.undetermined().size() > 0) return FailSingular(normal.undetermined());
      DatumTransformation transformation(datum);
      const Eigen::VectorXd total = transformation(shift + normal.Solve(system.RightSide()));
      const double step_size = (total - shift).size() > 0 ? (total - shift).cwiseAbs().maxCoeff() : 0.0;
      state_.Add(total - shift, result_.unknowns);
      shift = total;
      if (!std::isfinite(step_size)) break;
      if (step_size > kConverged) continue;
      final_ = System();
      result_.cofactors = std::make_shared<SparseCofactors>(std::move(normal), std::move(transformation));
      return true;
    }
    return Fail("the adjustment does not converge (" + summary.message + ")");
  }

  bool FailSingular(const Eigen::VectorXd& motion) {
    return Fail("the observations do not determine the network: they leave open how these points lie: " +
                PointsThatMove(network_, result_.unknowns, motion));
  }

  Eigen::VectorXd Shift(const NetworkState& start) const {
    Eigen::VectorXd shift(result_.unknowns.size());
    for (int k = 0; k < shift.size(); ++k) {
      const Unknowns::Owner owner = result_.unknowns.OwnerOf(k);
      shift[k] = owner.point < 0 ? state_.orientations[static_cast<std::size_t>(owner.component)] -
                                       start.orientations[static_cast<std::size_t>(owner.component)]
                                 : state_.positions[static_cast<std::size_t>(owner.point)][owner.component] -
                                       start.positions[static_cast<std::size_t>(owner.point)][owner.component];
    }
    return shift;
  }

  bool SolveDenseSystem() {
    const Datum datum = FindDatum(network_, state_, result_.unknowns, System());
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(result_.unknowns.size());
    for (int step = 0; step < kMaxSteps; ++step) {
      const DenseSolution solution = SolveDense(System(), datum.defines, shift);
      result_.defect = solution.defect;
      result_.iterations = step + 1;
      if (!solution.usable) return Fail("the network has no datum, or the observations do not determine it");
      state_.Add(solution.correction, result_.unknowns);
      shift += solution.correction;
      if (solution.correction.size() > 0 && solution.correction.cwiseAbs().maxCoeff() > kConverged) continue;
      final_ = System();
      result_.cofactors = std::make_shared<DenseCofactors>(solution.cofactors);
      return true;
    }
    return Fail("the adjustment does not converge");
  }

  void Collect() {
    result_.num_unknowns = result_.unknowns.size();
    result_.num_observations = static_cast<int>(network_.observations.size());
    result_.degrees_of_freedom = result_.num_observations - result_.num_unknowns + result_.defect;
    result_.chi_square = final_.SquareSum();
    if (result_.degrees_of_freedom > 0) {
      const double tail = (1.0 - network_.confidence) / 2.0;
      result_.chi_square_lower = ChiSquareQuantile(tail, result_.degrees_of_freedom);
      result_.chi_square_upper = ChiSquareQuantile(1.0 - tail, result_.degrees_of_freedom);
    }
    if (network_.use_sigma_a_posteriori) result_.scale = result_.VarianceRatioRoot();
    for (const double orientation : state_.orientations) {
      const double wrapped = WrappedAngle(orientation);
      result_.orientations.push_back(wrapped < 0.0 ? wrapped + 2.0 * M_PI : wrapped);
    }
    CollectPoints();
    result_.observations.resize(network_.observations.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) CollectGroup(groups_[g], final_.groups[g]);
    for (const ObservationResult& observation : result_.observations) {
      result_.largest_w = std::max(result_.largest_w, std::abs(observation.w));
      if (observation.redundancy < kUncontrolled) ++result_.num_untested;
    }
  }

  void CollectPoints() {
    for (std::size_t i = 0; i < network_.points.size(); ++i) {
      PointResult point{.position = state_.positions[i]};
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          const int row = result_.unknowns.Coordinate(static_cast<int>(i), a);
          const int column = result_.unknowns.Coordinate(static_cast<int>(i), b);
          if (row < 0 || column < 0) continue;
          // Height and plane of a point need not stand together in any observation.
          const bool together = a == b || (a < 2) == (b < 2) || Together(static_cast<int>(i));
          if (together) point.covariance(a, b) = result_.cofactors->At(row, column);
        }
      }
      result_.points.push_back(point);
    }
  }

  // Whether some observation depends on the point's plane coordinates and its height.
  bool Together(int point) {
    if (together_.empty()) {
      together_.assign(network_.points.size(), false);
      for (const EquationGroup& group : final_.groups) {
        std::vector<int> parts;  // point with plane: 2 i, with height: 2 i + 1
        for (const int unknown : group.unknowns) {
          const Unknowns::Owner owner = result_.unknowns.OwnerOf(unknown);
          if (owner.point >= 0) parts.push_back(2 * owner.point + (owner.component == 2 ? 1 : 0));
        }
        std::sort(parts.begin(), parts.end());
        for (const int part : parts) {
          if (part % 2 == 0 && std::binary_search(parts.begin(), parts.end(), part + 1)) {
            together_[static_cast<std::size_t>(part / 2)] = true;
          }
        }
      }
    }
    return together_[static_cast<std::size_t>(point)];
  }

  void CollectGroup(const ObservationGroup& group, const EquationGroup& equations) {
    const auto count = static_cast<Eigen::Index>(equations.unknowns.size());
    Eigen::MatrixXd q(count, count);
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = a; b < count; ++b) {
        q(a, b) = q(b, a) = result_.cofactors->At(equations.unknowns[static_cast<std::size_t>(a)],
                                                  equations.unknowns[static_cast<std::size_t>(b)]);
      }
    }
    // Whitened: cofactors of the adjusted observations and of the residuals, I minus that.
    const Eigen::MatrixXd adjusted = equations.jacobian * q * equations.jacobian.transpose();
    const Eigen::MatrixXd residual = Eigen::MatrixXd::Identity(adjusted.rows(), adjusted.cols()) - adjusted;
    const Eigen::MatrixXd& l = group.factor;
    const auto lower = l.triangularView<Eigen::Lower>();
    const Eigen::MatrixXd inverse = lower.solve(Eigen::MatrixXd::Identity(l.rows(), l.cols()));
    const Eigen::VectorXd v = -(l * equations.misclosure);
    const Eigen::VectorXd pv = -(inverse.transpose() * equations.misclosure);
    const Eigen::MatrixXd q_adjusted = l * adjusted * l.transpose();
    const Eigen::MatrixXd q_residual = l * residual * l.transpose();
    const Eigen::MatrixXd p_qvv_p = inverse.transpose() * residual * inverse;
    const Eigen::MatrixXd redundancy = l * residual * inverse;
    const double non_centrality = non_centrality_;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const Observation& observation = network_.observations[group.first + static_cast<std::size_t>(i)];
      ObservationResult& result = result_.observations[group.first + static_cast<std::size_t>(i)];
      result.residual = v[i];
      result.adjusted = observation.value + v[i];
      if (IsAngular(observation.kind)) {
        const double wrapped = WrappedAngle(result.adjusted);
        result.adjusted = wrapped < 0.0 ? wrapped + 2.0 * M_PI : wrapped;
      }
      result.sigma_adjusted = std::sqrt(std::max(0.0, q_adjusted(i, i)));
      result.redundancy = std::clamp(redundancy(i, i), 0.0, 1.0);
      const bool controlled = result.redundancy > kUncontrolled;
      result.sigma_residual = controlled ? std::sqrt(std::max(0.0, q_residual(i, i))) : 0.0;
      result.w = controlled ? pv[i] / std::sqrt(p_qvv_p(i, i)) : 0.0;
      result.estimated_error = controlled ? -pv[i] / p_qvv_p(i, i) : 0.0;
      result.minimal_detectable_bias = MinimalDetectableBias(controlled ? p_qvv_p(i, i) : 0.0, non_centrality);
    }
  }

  const Network& network_;
  const AdjustmentOptions& options_;
  NetworkAdjustment result_;
  std::vector<ObservationGroup> groups_;
  NetworkState state_;
  LinearSystem final_;
  std::vector<bool> together_;
  double non_centrality_ = NonCentrality(options_.test, 1);
};

}  // namespace

double NetworkAdjustment::VarianceRatioRoot() const {
  return degrees_of_freedom > 0 ? std::sqrt(chi_square / degrees_of_freedom) : 1.0;
}

Eigen::MatrixXd NetworkAdjustment::CovarianceOf(const std::vector<int>& points_asked) const {
  const auto count = static_cast<Eigen::Index>(points_asked.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (Eigen::Index j = 0; j < 3 * count; ++j) {
    const int unknown = unknowns.Coordinate(points_asked[static_cast<std::size_t>(j / 3)], static_cast<int>(j % 3));
    if (unknown < 0) continue;
    const Eigen::VectorXd column = cofactors->Column(unknown);
    for (Eigen::Index i = 0; i < 3 * count; ++i) {
      const int row = unknowns.Coordinate(points_asked[static_cast<std::size_t>(i / 3)], static_cast<int>(i % 3));
      if (row >= 0) covariance(i, j) = column[row] * scale * scale;
    }
  }
  return covariance;
}

NetworkAdjustment AdjustNetwork(const Network& network, const AdjustmentOptions& options) {
  return Adjuster(network, options).Run();
}

}  // namespace survey
