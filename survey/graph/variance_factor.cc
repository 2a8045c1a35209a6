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
  if (result.redundancy >= kLeastRedundancy && squares > 0.0) result.factor = squares / result.redundancy;
  return result;
}

PoseGraphSummary SolveFree(const PoseGraphOptions& options, PoseGraph* graph) {
  PoseGraphOptions free_options = options;
  free_options.chordal_start = true;  // a long tour may have drifted far
  PoseGraphSummary summary = Solve(graph, free_options);
  if (!summary.usable) return summary;
  const double factor = VarianceFactorOfLoops(*graph, options.robust_scale).factor;
  for (PoseEdge& edge : graph->edges) edge.covariance *= factor;
  summary.initial_cost /= factor;
  summary.final_cost /= factor;
  return summary;
}

}  // namespace survey
