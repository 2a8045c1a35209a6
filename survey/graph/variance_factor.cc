// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/variance_factor.h"

#include "survey/graph/graph_covariance.h"

namespace survey {
namespace {

constexpr double kLeastRedundancy = 12.0;  // the factor's own sigma is then 40 % of it

}  // namespace

VarianceFactor VarianceFactorOfLoops(const PoseGraph& graph, double robust_scale) {
  VarianceFactor result;
  const auto covariance = GraphCovariance::Of(graph);
  if (!covariance) return result;
  double squares = 0.0;
  for (const PoseEdge& edge : graph.edges) {
    if (!edge.robust) continue;
    const double square = SquaredNormalisedResidual(edge, graph.poses);
    const double weight = 1.0 / (1.0 + square / (robust_scale * robust_scale));  // Cauchy
    squares += weight * square;
    result.redundancy += weight * covariance->RedundancyOf(edge);
  }
  result.told = result.redundancy >= kLeastRedundancy && squares > 0.0;
  if (result.told) result.factor = squares / result.redundancy;
  return result;
}

FreeSolution SolveFree(const PoseGraphOptions& options, PoseGraph* graph) {
  PoseGraphOptions free_options = options;
  free_options.chordal_start = true;  // a long tour may have drifted far
  FreeSolution free{.summary = Solve(graph, free_options)};
  if (!free.summary.usable) return free;
  free.factor = VarianceFactorOfLoops(*graph, options.robust_scale);
  for (PoseEdge& edge : graph->edges) edge.covariance *= free.factor.factor;
  free.summary.initial_cost /= free.factor.factor;
  free.summary.final_cost /= free.factor.factor;
  return free;
}

}  // namespace survey
