// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/site_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "survey/graph/control_tie.h"
#include "survey/graph/given_control.h"
#include "survey/graph/graph_covariance.h"
#include "survey/graph/graph_residuals.h"
#include "survey/graph/loop_consistency.h"
#include "survey/graph/variance_components.h"
#include "survey/stats/mahalanobis.h"

namespace survey {
namespace {

constexpr double kIndependentMatches = 2.0;        // in one submap, whose own errors all of them share
constexpr int kFactorRounds = 3;                   // of the variance factor and the solution
const Eigen::Vector3d kBending(1e-4, 1e-4, 1e-6);  // of submap and scan in their blocks: m2, m2, rad2

constexpr double kLeastRedundancy = 12.0;  // for a factor: its own sigma is then 40 % of it

// Squares of the matches' residuals against their redundancy, weighted as the robust loss does; 1 where too few tell.
double FactorOfMatches(const PoseGraph& graph, double robust_scale) {
  const auto covariance = GraphCovariance::Of(graph);
  if (!covariance) return 1.0;
  KindEvidence matches;
  for (const PoseEdge& edge : graph.edges) {
    if (!edge.robust) continue;
    const double square = SquaredNormalisedResidual(edge, graph.poses);
    const double weight = 1.0 / (1.0 + square / (robust_scale * robust_scale));  // Cauchy
    matches.squares += weight * square;
    matches.redundancy += weight * covariance->RedundancyOf(edge);
  }
  return matches.redundancy >= kLeastRedundancy ? matches.Factor() : 1.0;
}

// A match as an edge of the site's graph.
struct MatchEdge {
  std::size_t pair = 0;
  PoseEdge edge;
  double distance_before = 0.0;
};

class Site {
 public:
  Site(const ControlNetwork& control, double robust_scale, std::vector<SiteBlock>* blocks,
       std::vector<MatchedPair> pairs)
      : control_(control), solver_{.robust_scale = robust_scale}, blocks_(*blocks), pairs_(std::move(pairs)) {}

  SiteAdjustment Run() {
    CollectBlocks();
    result_.usable = GiveCoordinates() && SolveByControl() && SolveWithMatches() && ReadSolution();
    return std::move(result_);
  }

 private:
  bool Fail(const std::string& message) {
    result_.message = message;
    return false;
  }

  bool Joined(std::size_t block) const { return blocks_[block].graph.control.size() >= 2; }

  // All joined blocks side by side; control points of the same name are one.
  void CollectBlocks() {
    std::map<std::string, int> times_used;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (!Joined(b)) {
        result_.summary.apart.push_back(blocks_[b].name);
        continue;
      }
      for (const std::string& name : blocks_[b].graph.control) ++times_used[name];
    }
    for (const auto& [name, times] : times_used) {
      names_.push_back(name);
      if (times > 1) ++result_.summary.num_shared;
    }
    result_.summary.num_control_points = static_cast<int>(names_.size());
    graph_.points.resize(names_.size());
    first_pose_.resize(blocks_.size());
    point_of_.resize(blocks_.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (Joined(b)) Append(b);
    }
  }

  void Append(std::size_t b) {
    const ControlledGraph& block = blocks_[b].graph;
    const PoseGraph& own = block.block.graph;
    if (graph_.poses.empty()) offset_ = own.poses.front().Translation().array().round();
    const int first = static_cast<int>(graph_.poses.size());
    first_pose_[b] = first;
    for (std::size_t i = 0; i < NumMoved(block); ++i)
      graph_.poses.push_back({own.poses[i].x - offset_.x(), own.poses[i].y - offset_.y(), own.poses[i].theta});
    for (std::size_t p = 0; p < own.points.size(); ++p) {
      point_of_[b].push_back(PlaceOfPoint(block, p));
      graph_.points[IndexOf(point_of_[b].back())] = own.points[p] - offset_;
    }
    const auto place_of = [&](int pose) { return pose == block.site_pose ? SitePose() : first + pose; };
    for (GivenCoordinates given : own.given) {
      for (std::size_t i = 0; i < given.points.size(); ++i) {
        given.points[i] = point_of_[b][IndexOf(given.points[i])];
        given.coordinates.segment<2>(2 * static_cast<Eigen::Index>(i)) -= offset_;
      }
      graph_.given.push_back(std::move(given));
    }
    for (MarkEdge mark : own.marks) {
      mark.point = point_of_[b][IndexOf(mark.point)];
      mark.pose += first;
      graph_.marks.push_back(mark);
    }
    for (PoseEdge edge : own.edges) {
      edge.base = place_of(edge.base);
      edge.target = place_of(edge.target);
      graph_.edges.push_back(edge);
    }
    for (WallEdge edge : own.walls) {
      edge.base += first;
      edge.target += first;
      graph_.walls.push_back(edge);
    }
  }

  // Its submaps and nodes.
  static std::size_t NumMoved(const ControlledGraph& block) {
    return block.block.num_submaps + block.block.nodes.size();
  }

  // The site frame as a pose that is held, made when the first answer hangs on it.
  int SitePose() {
    if (!graph_.fixed_pose) {
      graph_.fixed_pose = static_cast<int>(graph_.poses.size());
      graph_.poses.push_back({-offset_.x(), -offset_.y(), 0.0});
    }
    return *graph_.fixed_pose;
  }

  int PlaceOfPoint(const ControlledGraph& block, std::size_t point) {
    const bool named = point < block.block.point_names.size();
    if (named && std::binary_search(block.control.begin(), block.control.end(), block.block.point_names[point])) {
      const auto name = std::lower_bound(names_.begin(), names_.end(), block.block.point_names[point]);
      return static_cast<int>(name - names_.begin());
    }
    graph_.points.emplace_back();
    return static_cast<int>(graph_.points.size()) - 1;
  }

  bool GiveCoordinates() {
    GivenControl given = GiveControl(control_, names_, {}, offset_);
    if (!given.problem.empty()) return Fail(given.problem);
    graph_.given.insert(graph_.given.end(), given.given.begin(), given.given.end());
    return true;
  }

  bool Solve() {
    const PoseGraphSummary summary = survey::Solve(&graph_, solver_);
    return summary.usable || Fail("the joint adjustment did not converge: " + summary.message);
  }

  // Control alone, each point's coordinates once; then the matches are held against it.
  bool SolveByControl() {
    for (const MatchedPair& pair : pairs_)
      result_.summary.pairs.push_back({.block_a = blocks_[pair.first].name, .block_b = blocks_[pair.second].name});
    if (!Solve()) return false;
    const auto covariance = GraphCovariance::Of(graph_);
    if (!covariance) return Fail("parts of the site hang together by nothing: it cannot be adjusted");
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (Joined(pairs_[p].first) && Joined(pairs_[p].second)) TakeMatches(p, *covariance);
    }
    return true;
  }

  // Those that control lets expect. Matches in one submap share its errors: together they weigh as a few.
  void TakeMatches(std::size_t p, const GraphCovariance& covariance) {
    JointPair& pair = result_.summary.pairs[p];
    pair.num_matches = static_cast<int>(pairs_[p].matches.size());
    const std::size_t first = matches_.size();
    std::map<int, int> count;  // by submap
    double variance = 0.0;
    int agreeing = 0;
    for (const Loop& match : pairs_[p].matches) {
      if (!match.accepted) continue;
      ++agreeing;
      const PoseEdge edge = EdgeOf(pairs_[p], match);
      const Eigen::Matrix3d expected = ExpectedCovariance(edge, covariance);
      const Eigen::Vector3d error = ErrorOf(edge);
      if (SquaredMahalanobis(error, expected) > kChiSquare3) continue;
      variance += expected.topLeftCorner<2, 2>().trace();
      ++count[edge.base];
      matches_.push_back({p, edge, error.head<2>().norm()});
    }
    const auto taken = static_cast<int>(matches_.size() - first);
    pair.contradicts = 2 * taken < agreeing;
    if (pair.contradicts) matches_.resize(first);
    pair.sigma = taken > 0 ? std::sqrt(variance / taken) : 0.0;
    for (std::size_t i = first; i < matches_.size(); ++i)
      matches_[i].edge.covariance *= std::max(1.0, count[matches_[i].edge.base] / kIndependentMatches);
  }

  PoseEdge EdgeOf(const MatchedPair& pair, const Loop& match) const {
    const SubmapConstraint& measured = match.constraint;
    PoseEdge edge{first_pose_[pair.first] + blocks_[pair.first].graph.block.PoseOf(measured.submap),
                  first_pose_[pair.second] + blocks_[pair.second].graph.block.PoseOf(measured.scan),
                  measured.submap_from_scan,
                  measured.covariance,
                  true,
                  EdgeKind::kLoop};
    edge.covariance.diagonal() += kBending;
    return edge;
  }

  RelativePoseResidual ResidualOf(const PoseEdge& edge) const {
    return EvaluateRelativePose(graph_.poses[IndexOf(edge.base)], graph_.poses[IndexOf(edge.target)],
                                edge.base_from_target);
  }
  Eigen::Vector3d ErrorOf(const PoseEdge& edge) const { return ResidualOf(edge).error; }

  // Of a match against two blocks that control alone has placed.
  Eigen::Matrix3d ExpectedCovariance(const PoseEdge& edge, const GraphCovariance& covariance) const {
    const RelativePoseResidual r = ResidualOf(edge);
    return edge.covariance + r.d_base * covariance.OfPose(edge.base) * r.d_base.transpose() +
           r.d_target * covariance.OfPose(edge.target) * r.d_target.transpose();
  }

  void PutMatches(std::size_t num_own_edges) {
    graph_.edges.resize(num_own_edges);
    for (const MatchEdge& match : matches_) graph_.edges.push_back(match.edge);
  }

  bool SolveWithMatches() {
    const std::size_t num_own_edges = graph_.edges.size();
    if (matches_.empty()) return true;
    for (int round = 0; round < kFactorRounds; ++round) {
      PutMatches(num_own_edges);
      if (!Solve()) return false;
      const double factor = std::max(1.0, FactorOfMatches(graph_, solver_.robust_scale));
      for (MatchEdge& match : matches_) match.edge.covariance *= factor;
      result_.summary.match_factor *= factor;
    }
    std::erase_if(matches_, [&](const MatchEdge& match) {
      return SquaredNormalisedResidual(match.edge, graph_.poses) > kChiSquare3;
    });
    PutMatches(num_own_edges);
    if (!Solve()) return false;
    FreezeRobustWeights(&graph_);
    ReportPairs();
    return true;
  }

  void ReportPairs() {
    std::vector<double> before(pairs_.size(), 0.0), after(pairs_.size(), 0.0);
    for (const MatchEdge& match : matches_) {
      ++result_.summary.pairs[match.pair].num_used;
      before[match.pair] += match.distance_before * match.distance_before;
      after[match.pair] += ErrorOf(match.edge).head<2>().squaredNorm();
    }
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      JointPair& pair = result_.summary.pairs[p];
      if (pair.num_used == 0) continue;
      pair.rms_before = std::sqrt(before[p] / pair.num_used);
      pair.rms_after = std::sqrt(after[p] / pair.num_used);
    }
  }

  // Back into the blocks.
  bool ReadSolution() {
    const auto covariance = GraphCovariance::Of(graph_);
    if (!covariance) return Fail("the joint adjustment is singular");
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (!Joined(b)) continue;
      PoseGraph& own = blocks_[b].graph.block.graph;
      blocks_[b].covariances.clear();
      for (std::size_t i = 0; i < NumMoved(blocks_[b].graph); ++i) {
        const int pose = first_pose_[b] + static_cast<int>(i);
        const Pose2& moved = graph_.poses[IndexOf(pose)];
        own.poses[i] = {moved.x + offset_.x(), moved.y + offset_.y(), moved.theta};
        blocks_[b].covariances.push_back(covariance->OfPose(pose));
      }
      for (std::size_t i = 0; i < own.points.size(); ++i)
        own.points[i] = graph_.points[IndexOf(point_of_[b][i])] + offset_;
    }
    return true;
  }

  const ControlNetwork& control_;
  PoseGraphOptions solver_;
  std::vector<SiteBlock>& blocks_;
  std::vector<MatchedPair> pairs_;
  std::vector<std::string> names_;  // of the control points: the graph's first points
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();
  PoseGraph graph_;                         // plus the offset in the site frame
  std::vector<int> first_pose_;             // by block
  std::vector<std::vector<int>> point_of_;  // by block and its point
  std::vector<MatchEdge> matches_;
  SiteAdjustment result_;
};

double MeanSigma(const Solution& solution) {
  double variance = 0.0;
  for (const NodeCovariance& node : solution.covariances) variance += node.covariance.topLeftCorner<2, 2>().trace();
  return solution.covariances.empty() ? 0.0 : std::sqrt(variance / static_cast<double>(solution.covariances.size()));
}

void MoveScans(const std::vector<Pose2>& poses, Solution* solution, JointBlock* report) {
  double squares = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double shift = (poses[i].Translation() - solution->scans[i].site_from_scan.Translation()).norm();
    squares += shift * shift;
    solution->scans[i].site_from_scan = poses[i];
    if (shift <= report->max_shift) continue;
    report->max_shift = shift;
    report->place_of_max = poses[i].Translation();
  }
  report->rms_shift = poses.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(poses.size()));
}

void MoveMarks(const SiteBlock& block, Solution* solution) {
  const PoseGraph& graph = block.graph.block.graph;
  for (std::size_t i = 0; i < solution->marks.size(); ++i) {
    SolvedMark& mark = solution->marks[i];
    const MarkEdge& edge = graph.marks[i];
    const Pose2& pose = graph.poses[IndexOf(edge.pose)];
    const Eigen::Vector2d given = mark.position_in_site - mark.residual;
    mark.position_in_site = pose * edge.p_in_pose;
    mark.covariance = CovarianceOfMark(edge, pose, block.covariances[IndexOf(edge.pose)]);
    if (mark.used || !mark.left_out.empty()) mark.residual = mark.position_in_site - given;
  }
}

}  // namespace

SiteAdjustment AdjustSite(const ControlNetwork& control, double robust_scale, std::vector<SiteBlock>* blocks,
                          std::vector<MatchedPair> pairs) {
  return Site(control, robust_scale, blocks, std::move(pairs)).Run();
}

JointBlock MoveSolution(const SiteBlock& block, const Track& track, const std::vector<StampNs>& stamps,
                        Solution* solution) {
  const BlockGraph& graph = block.graph.block;
  JointBlock report{.name = block.name, .sigma_before = MeanSigma(*solution)};
  MoveScans(PosesOfAllScans(track, graph, stamps), solution, &report);
  for (SolvedSubmap& submap : solution->submaps)
    submap.site_from_submap = graph.graph.poses[IndexOf(graph.PoseOf(submap.id))];
  for (NodeCovariance& node : solution->covariances)
    node.covariance = block.covariances[IndexOf(graph.PoseOf(node.scan))];
  MoveMarks(block, solution);
  report.sigma_after = MeanSigma(*solution);
  return report;
}

}  // namespace survey
