// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/variance_components.h"

#include <algorithm>
#include <cmath>

#include "survey/graph/graph_covariance.h"
#include "survey/stats/reliability.h"

namespace survey {
namespace {

constexpr double kLeastRedundancy = 12.0;  // of both, or of a kind: a factor's own sigma is then 40 % of it
// The largest that buildings with many loops show (docs/reliability.md); counts as much as so many conditions.
constexpr double kUsualFactor = 0.25;
constexpr double kUsualRedundancy = 2.0;
constexpr double kLeastFactor = 2e-3;  // sigmas of 1 : 20
constexpr double kLargestFactor = 1e4;
constexpr double kFarthestApart = 4.0;  // a kind's factor from that of both
constexpr int kMaxRounds = 10;
constexpr double kConverged = 0.05;         // of the logarithm of a factor: far below its own sigma
constexpr double kRoughCost = 1.0;          // where the rounds take the steps that remain
constexpr double kNegligibleCost = 0.05;    // all observations together move by a third of a sigma
constexpr double kNegligibleSquares = 0.1;  // of the track alone: its copies agree

struct NetworkEvidence {
  KindEvidence track;
  KindEvidence loops;
};

// By least squares: a loop beyond the critical value counts as if it reached it, the others in full. The poses are near
// the solution and take the step that remains.
NetworkEvidence OfLoops(const KindEvidence& alone, PoseGraph* graph) {
  PoseGraph frozen = *graph;
  FreezeRobustWeights(&frozen);
  const auto covariance = GraphCovariance::Of(frozen);
  if (!covariance) return {};
  covariance->TakeStep(graph);
  frozen.poses = graph->poses;
  return {Beyond(EvidenceOf(frozen, *covariance, {EdgeKind::kScanMatch, EdgeKind::kMotion}), alone),
          EvidenceOf(frozen, *covariance, {EdgeKind::kLoop})};
}

// One factor for both kinds: the mean of what the residuals say and of what is usual, of their logarithms by their
// conditions.
double CommonFactor(const KindEvidence& both) {
  const double told = std::log(std::clamp(both.Factor(), kLeastFactor, kLargestFactor));
  const double mean =
      (both.redundancy * told + kUsualRedundancy * std::log(kUsualFactor)) / (both.redundancy + kUsualRedundancy);
  return std::exp(mean);
}

double SumOfSquares(const PoseGraph& graph) {
  double sum = 0.0;
  for (const PoseEdge& edge : graph.edges) sum += SquaredNormalisedResidual(edge, graph.poses);
  return sum;
}

bool IsOne(double factor) { return std::abs(std::log(factor)) < kConverged; }

class FactorSearch {
 public:
  FactorSearch(PoseGraphOptions options, PoseGraph* graph) : options_(options), graph_(*graph) {
    options_.negligible_cost = kNegligibleCost;
    result_.alone = TrackAlone(*graph).value_or(KindEvidence{});
  }

  FreeSolution Run() {
    PoseGraphOptions first = options_;
    first.negligible_cost = kRoughCost;
    first.chordal_start = true;  // a long tour may have drifted far
    result_.summary = Solve(&graph_, first);
    if (!result_.summary.usable) return result_;
    // Again and again: which loops are beyond the critical value, and who is to blame, depends on the factors.
    for (int round = 0; round < kMaxRounds; ++round) {
      if (Apply(FactorsBy(OfLoops(result_.alone, &graph_)))) break;
    }
    result_.summary = Solve(&graph_, options_);
    return result_;
  }

 private:
  // One factor for both kinds, or one for each where both have enough conditions.
  NetworkFactors FactorsBy(NetworkEvidence evidence) const {
    evidence.track.squares *= result_.factors.track;  // by the covariances that the sensors gave
    evidence.loops.squares *= result_.factors.loops;
    const KindEvidence both{evidence.track.squares + evidence.loops.squares,
                            evidence.track.redundancy + evidence.loops.redundancy};
    const double common = CommonFactor(both);
    const double conditions = both.redundancy + kUsualRedundancy;
    if (std::min(evidence.track.redundancy, evidence.loops.redundancy) < kLeastRedundancy)
      return {common, common, both.redundancy >= kLeastRedundancy, conditions};
    const auto near = [&](double factor) {
      return std::clamp(factor, common / kFarthestApart, common * kFarthestApart);
    };
    return {near(evidence.track.Factor()), near(evidence.loops.Factor()), true, conditions};
  }

  // Puts the factors to these values; true when they hardly changed.
  bool Apply(const NetworkFactors& factors) {
    const double by_track = factors.track / result_.factors.track, by_loops = factors.loops / result_.factors.loops;
    for (PoseEdge& edge : graph_.edges) {
      if (!edge.blind) edge.covariance *= IsLoop(edge) ? by_loops : by_track;
    }
    result_.alone.squares /= by_track;
    result_.factors = factors;
    return IsOne(by_track) && IsOne(by_loops);
  }

  PoseGraphOptions options_;
  PoseGraph& graph_;
  FreeSolution result_;
};

}  // namespace

void FreezeRobustWeights(PoseGraph* graph) {
  const double critical = CriticalT(0.001, 3);
  for (PoseEdge& edge : graph->edges) {
    if (!edge.robust) continue;
    edge.covariance *= std::max(1.0, SquaredNormalisedResidual(edge, graph->poses) / critical);
    edge.robust = false;
  }
}

KindEvidence EvidenceOf(const PoseGraph& graph, const GraphCovariance& covariance,
                        std::initializer_list<EdgeKind> kinds) {
  KindEvidence sum;
  for (const PoseEdge& edge : graph.edges) {
    if (edge.blind || std::find(kinds.begin(), kinds.end(), edge.kind) == kinds.end()) continue;
    sum.squares += SquaredNormalisedResidual(edge, graph.poses);
    sum.redundancy += covariance.RedundancyOf(edge);
  }
  return sum;
}

std::optional<KindEvidence> TrackAlone(const PoseGraph& graph) {
  PoseGraph alone = graph;
  std::erase_if(alone.edges, [](const PoseEdge& edge) {
    return edge.kind != EdgeKind::kScanMatch && edge.kind != EdgeKind::kMotion;
  });
  alone.marks.clear();
  alone.points.clear();
  alone.walls.clear();
  alone.given.clear();
  alone.fixed_pose = 0;
  if (SumOfSquares(alone) > kNegligibleSquares && !Solve(&alone, {}).usable) return std::nullopt;
  return KindEvidence{SumOfSquares(alone), static_cast<double>(DegreesOfFreedom(alone))};
}

KindEvidence Beyond(const KindEvidence& track, const KindEvidence& alone) {
  return {std::max(0.0, track.squares - alone.squares), std::max(0.0, track.redundancy - alone.redundancy)};
}

FreeSolution SolveFree(const PoseGraphOptions& options, PoseGraph* graph) { return FactorSearch(options, graph).Run(); }

}  // namespace survey
