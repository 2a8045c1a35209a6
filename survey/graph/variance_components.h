// SPDX-License-Identifier: Apache-2.0
//
// How honest the a-priori covariances of a block's relative observations are, by kind, and made honest ([Foerstner79],
// iterated). There are two kinds: the track (memberships and motions, two copies of one measurement that fit each other
// whatever its errors) and the loops. What the track got wrong shows only where loops bend it: the squares of its
// residuals with the loops minus those that it has alone, against the redundancy that the loops bring. What the loops
// got wrong shows in their own residuals. Where both kinds have enough conditions each has a factor, not far from that
// of both together; otherwise one factor serves both, near to what is usual where few loops tell. All multiply
// covariances.
#pragma once

#include <initializer_list>
#include <optional>

#include "survey/graph/graph_covariance.h"
#include "survey/graph/pose_graph.h"

namespace survey {

// Of one kind: weighted squares of its residuals and the redundancy that they have.
struct KindEvidence {
  double squares = 0.0;
  double redundancy = 0.0;

  double Factor() const { return redundancy > 0.0 ? squares / redundancy : 0.0; }
};

// Over the edges of some kinds, without blind motions.
KindEvidence EvidenceOf(const PoseGraph& graph, const GraphCovariance& covariance,
                        std::initializer_list<EdgeKind> kinds);

// What the track has in itself, without loops and answers. Empty where it cannot be solved. Marks on one point tie as
// loops do and are no part of it.
std::optional<KindEvidence> TrackAlone(const PoseGraph& graph);

// What others have bent the track by.
KindEvidence Beyond(const KindEvidence& track, const KindEvidence& alone);

// What the covariances of both kinds were multiplied by.
struct NetworkFactors {
  double track = 1.0;
  double loops = 1.0;
  bool told = false;        // by enough loops
  double conditions = 0.0;  // that say so, with those that the usual factor counts as
};

// Free solution: what the sensors alone say. Afterwards the covariances of all edges are those that the loops have
// confirmed.
struct FreeSolution {
  PoseGraphSummary summary;
  NetworkFactors factors;  // applied to the covariances
  KindEvidence alone;      // of the track, before others bent it
};
FreeSolution SolveFree(const PoseGraphOptions& options, PoseGraph* graph);

// A robust edge whose squared residual is beyond the critical value (0.001) gets the covariance under which it would
// just reach it, and counts as any other from then on.
void FreezeRobustWeights(PoseGraph* graph);

}  // namespace survey
