// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <array>
#include <numeric>

#include "survey/graph/chordal_start.h"
#include "survey/graph/graph_residuals.h"
#include "survey/stats/mahalanobis.h"

namespace survey {
namespace {

template <int Rows, int Columns>
using RowMajor = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;

class RelativePoseCost : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit RelativePoseCost(const PoseEdge& edge)
      : base_from_target_(edge.base_from_target), whitening_(Whitening<3>(edge.covariance)) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const auto pose = [](const double* p) { return Pose2{p[0], p[1], p[2]}; };
    const RelativePoseResidual r = EvaluateRelativePose(pose(parameters[0]), pose(parameters[1]), base_from_target_);
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = whitening_ * r.error;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor<3, 3>>(jacobians[0], 3, 3) = whitening_ * r.d_base;
    if (jacobians[1] != nullptr) Eigen::Map<RowMajor<3, 3>>(jacobians[1], 3, 3) = whitening_ * r.d_target;
    return true;
  }

 private:
  Pose2 base_from_target_;
  Eigen::Matrix3d whitening_;
};

class MarkCost : public ceres::SizedCostFunction<2, 3, 2> {
 public:
  explicit MarkCost(const MarkEdge& edge) : p_in_pose_(edge.p_in_pose), whitening_(Whitening<2>(edge.covariance)) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const MarkResidual r = EvaluateMark({parameters[0][0], parameters[0][1], parameters[0][2]},
                                        {parameters[1][0], parameters[1][1]}, p_in_pose_);
    Eigen::Map<Eigen::Vector2d>(residuals, 2) = whitening_ * r.error;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor<2, 3>>(jacobians[0], 2, 3) = whitening_ * r.d_pose;
    if (jacobians[1] != nullptr) Eigen::Map<RowMajor<2, 2>>(jacobians[1], 2, 2) = whitening_ * r.d_point;
    return true;
  }

 private:
  Eigen::Vector2d p_in_pose_;
  Eigen::Matrix2d whitening_;
};

class WallCost : public ceres::SizedCostFunction<2, 3, 3> {
 public:
  explicit WallCost(const WallEdge& edge) : walls_(edge.walls), weights_(edge.sigma.cwiseInverse().asDiagonal()) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const auto pose = [](const double* p) { return Pose2{p[0], p[1], p[2]}; };
    const WallResidual r = EvaluateWalls(walls_, pose(parameters[0]), pose(parameters[1]));
    Eigen::Map<Eigen::Vector2d>(residuals, 2) = weights_ * r.error;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor<2, 3>>(jacobians[0], 2, 3) = weights_ * r.d_base;
    if (jacobians[1] != nullptr) Eigen::Map<RowMajor<2, 3>>(jacobians[1], 2, 3) = weights_ * r.d_target;
    return true;
  }

 private:
  WallPair walls_;
  Eigen::Matrix2d weights_;
};

class GivenCoordinatesCost : public ceres::CostFunction {
 public:
  explicit GivenCoordinatesCost(const GivenCoordinates& given)
      : given_(given.coordinates), whitening_(Whitening<Eigen::Dynamic>(given.covariance)) {
    set_num_residuals(static_cast<int>(given_.size()));
    mutable_parameter_block_sizes()->assign(given.points.size(), 2);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index rows = given_.size();
    Eigen::VectorXd error = -given_;
    for (Eigen::Index row = 0; row < rows; row += 2)
      error.segment<2>(row) += Eigen::Map<const Eigen::Vector2d>(parameters[row / 2]);
    Eigen::Map<Eigen::VectorXd>(residuals, rows) = whitening_ * error;
    if (jacobians == nullptr) return true;
    for (Eigen::Index row = 0; row < rows; row += 2) {
      if (jacobians[row / 2] == nullptr) continue;
      Eigen::Map<RowMajor<Eigen::Dynamic, 2>>(jacobians[row / 2], rows, 2) = whitening_.middleCols<2>(row);
    }
    return true;
  }

 private:
  Eigen::VectorXd given_;
  Eigen::MatrixXd whitening_;
};

// The graph's unknowns as Ceres wants them, and back.
struct Unknowns {
  explicit Unknowns(const PoseGraph& graph) : poses(graph.poses.size()), points(graph.points.size()) { Read(graph); }

  void Read(const PoseGraph& graph) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      poses[i] = {graph.poses[i].x, graph.poses[i].y, graph.poses[i].theta};
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = {graph.points[i].x(), graph.points[i].y()};
  }
  void Write(PoseGraph* graph) const {
    for (std::size_t i = 0; i < poses.size(); ++i)
      graph->poses[i] = {poses[i][0], poses[i][1], NormalizeAngle(poses[i][2])};
    for (std::size_t i = 0; i < points.size(); ++i) graph->points[i] = {points[i][0], points[i][1]};
  }

  std::vector<std::array<double, 3>> poses;
  std::vector<std::array<double, 2>> points;
};

void BuildProblem(const PoseGraph& graph, double robust_scale, Unknowns* unknowns, ceres::Problem* problem) {
  const auto pose = [&](int index) { return unknowns->poses[static_cast<std::size_t>(index)].data(); };
  const auto point = [&](int index) { return unknowns->points[static_cast<std::size_t>(index)].data(); };
  for (std::size_t i = 0; i < graph.poses.size(); ++i) problem->AddParameterBlock(unknowns->poses[i].data(), 3);
  for (const PoseEdge& edge : graph.edges) {
    ceres::LossFunction* loss = edge.robust && robust_scale > 0.0 ? new ceres::CauchyLoss(robust_scale) : nullptr;
    problem->AddResidualBlock(new RelativePoseCost(edge), loss, pose(edge.base), pose(edge.target));
  }
  for (const MarkEdge& mark : graph.marks) {
    problem->AddResidualBlock(new MarkCost(mark), nullptr, pose(mark.pose), point(mark.point));
  }
  for (const WallEdge& walls : graph.walls) {
    problem->AddResidualBlock(new WallCost(walls), nullptr, pose(walls.base), pose(walls.target));
  }
  for (const GivenCoordinates& given : graph.given) {
    std::vector<double*> blocks;
    for (const int index : given.points) blocks.push_back(point(index));
    problem->AddResidualBlock(new GivenCoordinatesCost(given), nullptr, blocks);
  }
  if (graph.fixed_pose) problem->SetParameterBlockConstant(pose(*graph.fixed_pose));
}

// Steps that change nothing that the observations could tell are not worth another.
class EndWhenNegligible : public ceres::IterationCallback {
 public:
  explicit EndWhenNegligible(double cost) : cost_(cost) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    const bool negligible = step.iteration > 0 && step.step_is_successful && step.cost_change < cost_;
    return negligible ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  double cost_;
};

double Cost(ceres::Problem* problem) {
  double cost = 0.0;
  problem->Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

// Puts the unknowns where the headings and positions from the edges alone are, if that costs less.
void TakeChordalStart(const PoseGraph& graph, Unknowns* unknowns, ceres::Problem* problem) {
  const std::optional<PoseGraph> start = ChordalStart(graph);
  if (!start) return;
  const double given = Cost(problem);
  unknowns->Read(*start);
  if (!(Cost(problem) < given)) unknowns->Read(graph);
}

}  // namespace

PoseGraphSummary Solve(PoseGraph* graph, const PoseGraphOptions& options) {
  PoseGraphSummary result;
  if (graph->poses.empty() || (graph->edges.empty() && graph->marks.empty())) {
    result.usable = true;
    result.message = "nothing to adjust";
    return result;
  }
  Unknowns unknowns(*graph);
  ceres::Problem problem;
  BuildProblem(*graph, options.robust_scale, &unknowns, &problem);
  if (options.chordal_start) TakeChordalStart(*graph, &unknowns, &problem);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // a third faster here than supernodes, no BLAS
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-9;
  solver.initial_trust_region_radius = 1e8;  // close to Gauss-Newton: starts are good
  solver.num_threads = 1;                    // one order of summation: the same bytes on every machine
  solver.logging_type = ceres::SILENT;
  EndWhenNegligible end(options.negligible_cost);
  solver.callbacks.push_back(&end);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  result.usable = summary.IsSolutionUsable();
  result.message = summary.message;
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  unknowns.Write(graph);
  return result;
}

int DegreesOfFreedom(const PoseGraph& graph) {
  int dof = std::accumulate(graph.walls.begin(), graph.walls.end(), 0,
                            [](int sum, const WallEdge& edge) { return sum + edge.walls.Rows(); });
  dof += 3 * static_cast<int>(graph.edges.size()) + 2 * static_cast<int>(graph.marks.size()) -
         3 * static_cast<int>(graph.poses.size()) - 2 * static_cast<int>(graph.points.size()) +
         (graph.fixed_pose ? 3 : 0);
  for (const GivenCoordinates& given : graph.given) dof += 2 * static_cast<int>(given.points.size());
  return dof;
}

double SquaredNormalisedResidual(const PoseEdge& edge, const std::vector<Pose2>& poses) {
  const RelativePoseResidual r = EvaluateRelativePose(
      poses[static_cast<std::size_t>(edge.base)], poses[static_cast<std::size_t>(edge.target)], edge.base_from_target);
  return SquaredMahalanobis(r.error, edge.covariance);
}

}  // namespace survey
