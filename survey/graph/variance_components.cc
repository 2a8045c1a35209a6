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
constexpr int kEvidenceIterations = 5;  // poses are near the minimum already
constexpr double kConverged = 0.05;     // of the logarithm of a factor: far below its own sigma

bool IsLoop(const PoseEdge& edge) { return edge.kind == EdgeKind::kLoop; }

struct NetworkEvidence {
  KindEvidence track;
  KindEvidence loops;
};

// By least squares: a loop beyond the critical value counts as if it reached it, the others in full. The poses become
// those of this solution.
NetworkEvidence OfLoops(const KindEvidence& alone, PoseGraph* graph) {
  PoseGraph frozen = *graph;
  FreezeRobustWeights(&frozen);
  if (!Solve(&frozen, {.max_iterations = kEvidenceIterations}).usable) return {};
  graph->poses = frozen.poses;
  graph->points = frozen.points;
  const auto covariance = GraphCovariance::Of(frozen);
  if (!covariance) return {};
  return {Beyond(EvidenceOf(frozen, *covariance, {EdgeKind::kScanMatch, EdgeKind::kMotion}), alone),
          EvidenceOf(frozen, *covariance, {EdgeKind::kLoop})};
}

KindEvidence Both(const NetworkEvidence& evidence) {
  return {evidence.track.squares + evidence.loops.squares, evidence.track.redundancy + evidence.loops.redundancy};
}

// One factor for both kinds: the mean of what the residuals say and of what is usual, of their logarithms by their
// conditions.
double CommonFactor(const KindEvidence& both, double so_far) {
  const double told = std::log(std::clamp(so_far * both.Factor(), kLeastFactor, kLargestFactor));
  const double mean =
      (both.redundancy * told + kUsualRedundancy * std::log(kUsualFactor)) / (both.redundancy + kUsualRedundancy);
  return std::exp(mean);
}

bool IsOne(double factor) { return std::abs(std::log(factor)) < kConverged; }

class FactorSearch {
 public:
  FactorSearch(const PoseGraphOptions& options, PoseGraph* graph) : options_(options), graph_(*graph) {
    result_.alone = TrackAlone(*graph).value_or(KindEvidence{});
  }

  FreeSolution Run() {
    PoseGraphOptions first = options_;
    first.chordal_start = true;  // a long tour may have drifted far
    result_.summary = Solve(&graph_, first);
    if (!result_.summary.usable) return result_;
    // Twice: which loops are beyond the critical value depends on the factor.
    NetworkEvidence evidence = ApplyCommon(OfLoops(result_.alone, &graph_));
    if (std::min(evidence.track.redundancy, evidence.loops.redundancy) < kLeastRedundancy) {
      ApplyCommon(evidence);
    } else {
      ApplyByKind(evidence);
    }
    result_.summary = Solve(&graph_, options_);
    return result_;
  }

 private:
  // One factor for both; what the residuals say then.
  NetworkEvidence ApplyCommon(const NetworkEvidence& evidence) {
    const KindEvidence both = Both(evidence);
    result_.factors.told = both.redundancy >= kLeastRedundancy;
    const double common = CommonFactor(both, result_.factors.track);
    Apply(common, common);
    return OfLoops(result_.alone, &graph_);
  }

  void ApplyByKind(NetworkEvidence evidence) {
    const double common = result_.factors.track;
    const auto near = [&](double factor) {
      return std::clamp(factor, common / kFarthestApart, common * kFarthestApart);
    };
    for (int round = 0; round < kMaxRounds; ++round) {
      if (Apply(near(result_.factors.track * evidence.track.Factor()),
                near(result_.factors.loops * evidence.loops.Factor())))
        return;
      evidence = OfLoops(result_.alone, &graph_);
      if (std::min(evidence.track.redundancy, evidence.loops.redundancy) < kLeastRedundancy) return;
    }
  }

  // Puts the factors to these values; true when they hardly changed.
  bool Apply(double track, double loops) {
    const double by_track = track / result_.factors.track, by_loops = loops / result_.factors.loops;
    for (PoseEdge& edge : graph_.edges) edge.covariance *= IsLoop(edge) ? by_loops : by_track;
    result_.alone.squares /= by_track;
    result_.factors.track = track;
    result_.factors.loops = loops;
    return IsOne(by_track) && IsOne(by_loops);
  }

  const PoseGraphOptions& options_;
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
    if (std::find(kinds.begin(), kinds.end(), edge.kind) == kinds.end()) continue;
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
  if (!Solve(&alone, {}).usable) return std::nullopt;
  KindEvidence evidence{.redundancy = static_cast<double>(DegreesOfFreedom(alone))};
  for (const PoseEdge& edge : alone.edges) evidence.squares += SquaredNormalisedResidual(edge, alone.poses);
  return evidence;
}

KindEvidence Beyond(const KindEvidence& track, const KindEvidence& alone) {
  return {std::max(0.0, track.squares - alone.squares), std::max(0.0, track.redundancy - alone.redundancy)};
}

FreeSolution SolveFree(const PoseGraphOptions& options, PoseGraph* graph) { return FactorSearch(options, graph).Run(); }

}  // namespace survey
