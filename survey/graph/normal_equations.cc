// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/normal_equations.h"

#include <Eigen/LU>
#include <Eigen/OrderingMethods>

#include "survey/graph/graph_residuals.h"

namespace survey {
namespace {

// Sums up the equations block by block; a negative place is held: nothing is added there.
class Sum {
 public:
  explicit Sum(int columns) : right_(Eigen::VectorXd::Zero(columns)) {}

  // Adds a block to (row, column) and, outside the diagonal, means its transpose too.
  template <typename Block>
  void Add(int row, int column, const Block& expression) {
    if (row < 0 || column < 0) return;
    const auto block = expression.eval();
    for (int i = 0; i < static_cast<int>(block.rows()); ++i) {
      for (int j = 0; j < static_cast<int>(block.cols()); ++j) {
        if (row != column && row < column) {
          entries_.emplace_back(column + j, row + i, block(i, j));
        } else if (row + i >= column + j) {
          entries_.emplace_back(row + i, column + j, block(i, j));
        }
      }
    }
  }

  template <typename Vector>
  void AddRight(int row, const Vector& vector) {
    if (row >= 0) right_.segment(row, vector.size()) += vector;
  }

  // One observation of two unknowns: error and its derivatives.
  template <typename Error, typename First, typename Second, typename Weight>
  void AddObservation(int a, const First& d_a, int b, const Second& d_b, const Weight& weight, const Error& error) {
    Add(a, a, d_a.transpose() * weight * d_a);
    Add(b, b, d_b.transpose() * weight * d_b);
    Add(a, b, d_a.transpose() * weight * d_b);
    AddRight(a, -d_a.transpose() * weight * error);
    AddRight(b, -d_b.transpose() * weight * error);
  }

  void MoveTo(NormalEquations* equations) {
    equations->lower.resize(right_.size(), right_.size());
    equations->lower.setFromTriplets(entries_.begin(), entries_.end());
    equations->right = std::move(right_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

// Poses, then points, in an order in which their elimination fills little: approximate minimum degree.
std::vector<int> OrderOfElimination(const PoseGraph& graph) {
  const auto num_poses = static_cast<int>(graph.poses.size());
  const int size = num_poses + static_cast<int>(graph.points.size());
  std::vector<Eigen::Triplet<double>> joined;
  joined.reserve(static_cast<std::size_t>(size) + graph.edges.size() + graph.marks.size());
  for (int i = 0; i < size; ++i) joined.emplace_back(i, i, 1.0);
  for (const PoseEdge& edge : graph.edges) joined.emplace_back(edge.base, edge.target, 1.0);
  for (const WallEdge& walls : graph.walls) joined.emplace_back(walls.base, walls.target, 1.0);
  for (const MarkEdge& mark : graph.marks) joined.emplace_back(mark.pose, num_poses + mark.point, 1.0);
  for (const GivenCoordinates& given : graph.given) {
    for (const int a : given.points) {
      for (const int b : given.points) joined.emplace_back(num_poses + a, num_poses + b, 1.0);
    }
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(joined.begin(), joined.end());
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(pattern, order);
  return {order.indices().begin(), order.indices().end()};
}

std::vector<bool> ObservedPoints(const PoseGraph& graph) {
  std::vector<bool> observed(graph.points.size(), false);
  for (const MarkEdge& mark : graph.marks) observed[IndexOf(mark.point)] = true;
  for (const GivenCoordinates& given : graph.given) {
    for (const int point : given.points) observed[IndexOf(point)] = true;
  }
  return observed;
}

// Gives the unknowns their columns; returns how many there are.
int NumberColumns(const PoseGraph& graph, NormalEquations* equations) {
  int columns = 0;
  equations->columns.of_pose.assign(graph.poses.size(), -1);
  equations->columns.of_point.assign(graph.points.size(), -1);
  const std::vector<bool> observed = ObservedPoints(graph);
  for (const int unknown : OrderOfElimination(graph)) {
    const std::size_t i = IndexOf(unknown);
    if (i < graph.poses.size()) {
      if (graph.fixed_pose == unknown) continue;
      equations->columns.of_pose[i] = columns;
      columns += 3;
    } else if (observed[i - graph.poses.size()]) {
      equations->columns.of_point[i - graph.poses.size()] = columns;
      columns += 2;
    }
  }
  return columns;
}

void AddGiven(const PoseGraph& graph, const GivenCoordinates& given, const std::vector<int>& column_of, Sum* sum) {
  const Eigen::MatrixXd weight = given.covariance.inverse();
  Eigen::VectorXd error = -given.coordinates;
  for (std::size_t k = 0; k < given.points.size(); ++k)
    error.segment<2>(2 * static_cast<Eigen::Index>(k)) += graph.points[IndexOf(given.points[k])];
  const Eigen::VectorXd pull = weight * error;
  for (std::size_t k = 0; k < given.points.size(); ++k) {
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(k);
    const int point = column_of[IndexOf(given.points[k])];
    sum->AddRight(point, -pull.segment<2>(row));
    for (std::size_t l = 0; l <= k; ++l) {
      sum->Add(point, column_of[IndexOf(given.points[l])], weight.block<2, 2>(row, 2 * static_cast<Eigen::Index>(l)));
    }
  }
}

}  // namespace

NormalEquations FormNormalEquations(const PoseGraph& graph) {
  NormalEquations equations;
  Sum sum(NumberColumns(graph, &equations));
  for (const PoseEdge& edge : graph.edges) {
    const RelativePoseResidual r =
        EvaluateRelativePose(graph.poses[IndexOf(edge.base)], graph.poses[IndexOf(edge.target)], edge.base_from_target);
    sum.AddObservation(equations.columns.of_pose[IndexOf(edge.base)], r.d_base,
                       equations.columns.of_pose[IndexOf(edge.target)], r.d_target,
                       Eigen::Matrix3d(edge.covariance.inverse()), r.error);
  }
  for (const MarkEdge& mark : graph.marks) {
    const MarkResidual r =
        EvaluateMark(graph.poses[IndexOf(mark.pose)], graph.points[IndexOf(mark.point)], mark.p_in_pose);
    sum.AddObservation(equations.columns.of_pose[IndexOf(mark.pose)], r.d_pose,
                       equations.columns.of_point[IndexOf(mark.point)], r.d_point,
                       Eigen::Matrix2d(mark.covariance.inverse()), r.error);
  }
  for (const WallEdge& edge : graph.walls) {
    const WallResidual r =
        EvaluateWalls(edge.walls, graph.poses[IndexOf(edge.base)], graph.poses[IndexOf(edge.target)]);
    const Eigen::Matrix2d weight = edge.sigma.cwiseAbs2().cwiseInverse().asDiagonal();
    sum.AddObservation(equations.columns.of_pose[IndexOf(edge.base)], r.d_base,
                       equations.columns.of_pose[IndexOf(edge.target)], r.d_target, weight, r.error);
  }
  for (const GivenCoordinates& given : graph.given) AddGiven(graph, given, equations.columns.of_point, &sum);
  sum.MoveTo(&equations);
  return equations;
}

}  // namespace survey
