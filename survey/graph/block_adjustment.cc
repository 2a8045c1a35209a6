// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/block_adjustment.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "survey/graph/answers_against_loops.h"
#include "survey/graph/block_graph.h"
#include "survey/graph/control_tie.h"
#include "survey/graph/graph_covariance.h"
#include "survey/graph/site_answers.h"
#include "survey/graph/variance_components.h"

namespace survey {
namespace {

Eigen::Vector2d MarkPosition(const PoseGraph& graph, const MarkEdge& mark) {
  return graph.poses[static_cast<std::size_t>(mark.pose)] * mark.p_in_pose;
}

// Control points that are marked in the block.
std::vector<const ControlPoint*> MarkedControl(const ControlNetwork& control, const BlockGraph& block) {
  std::vector<const ControlPoint*> marked;
  for (const ControlPoint& point : control.points) {
    const bool known = std::binary_search(block.point_names.begin(), block.point_names.end(), point.name);
    if (known && point.role == PointRole::kControl) marked.push_back(&point);
  }
  return marked;
}

// One point: the block is shifted onto it; its direction stays that of the first scan.
ControlTie ShiftOntoPoint(const ControlPoint& control, BlockGraph* block) {
  PoseGraph& graph = block->graph;
  ControlTie tie{.usable = true};
  tie.marks.resize(graph.marks.size());
  for (std::size_t i = 0; i < graph.marks.size(); ++i) {
    if (block->point_names[static_cast<std::size_t>(graph.marks[i].point)] != control.name) continue;
    tie.marks[i].on_control = tie.marks[i].used = true;
    tie.marks[i].given = control.position_in_site;
    const Eigen::Vector2d shift = control.position_in_site - MarkPosition(graph, graph.marks[i]);
    tie.site_from_local = {shift.x(), shift.y(), 0.0};
  }
  for (std::size_t i = 0; i < graph.marks.size(); ++i)
    tie.marks[i].rigid = tie.site_from_local * MarkPosition(graph, graph.marks[i]);
  tie.offset = tie.site_from_local.Translation();
  return tie;
}

// Displacement of a marked place some seconds later, as the track has it.
MotionInScan MotionOfTrack(const Track& track, const std::vector<StampNs>& stamps) {
  return [&](std::size_t mark, double seconds) -> std::optional<Eigen::Vector2d> {
    const TrackedMark& tracked = track.marks[mark];
    const auto carrier = static_cast<std::size_t>(tracked.scan.value);
    const StampNs wanted = stamps[carrier] + static_cast<StampNs>(std::llround(seconds * 1e9));
    const auto after = std::lower_bound(stamps.begin(), stamps.end(), wanted);
    if (after == stamps.begin() || after == stamps.end()) return std::nullopt;
    const auto j = static_cast<std::size_t>(after - stamps.begin());
    const double fraction = static_cast<double>(wanted - stamps[j - 1]) /
                            static_cast<double>(std::max<StampNs>(1, stamps[j] - stamps[j - 1]));
    const Pose2 then = Interpolate(track.scans[j - 1].local_from_scan, track.scans[j].local_from_scan, fraction);
    return Between(track.scans[carrier].local_from_scan, then) * tracked.mark_in_scan - tracked.mark_in_scan;
  };
}

// Pose indices of the nodes whose covariances are wanted: every marked one and one per stretch of path.
std::vector<int> NodesForCovariance(const BlockGraph& block, double spacing_m) {
  const std::size_t end = block.num_submaps + block.nodes.size();
  std::vector<bool> marked(end, false);
  for (const MarkEdge& mark : block.graph.marks) marked[static_cast<std::size_t>(mark.pose)] = true;
  std::vector<int> chosen;
  double way = spacing_m;
  for (std::size_t i = block.num_submaps; i < end; ++i) {
    if (i > block.num_submaps)
      way += (block.graph.poses[i].Translation() - block.graph.poses[i - 1].Translation()).norm();
    if (!marked[i] && way < spacing_m) continue;
    chosen.push_back(static_cast<int>(i));
    if (way >= spacing_m) way = 0.0;
  }
  return chosen;
}

class Writer {
 public:
  Writer(const Track& track, const BlockGraph& block, const Eigen::Vector2d& offset, Solution* solution)
      : track_(track), block_(block), offset_(offset), solution_(*solution) {}

  void Poses(const std::vector<StampNs>& stamps) {
    const std::vector<Pose2> poses = PosesOfAllScans(track_, block_, stamps);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      solution_.scans.push_back({track_.scans[i].scan, InSite(poses[i]), track_.scans[i].is_node});
    }
    for (const Submap& submap : track_.submaps) {
      solution_.submaps.push_back({submap.id, InSite(block_.graph.poses[static_cast<std::size_t>(submap.id.value)])});
    }
  }

  void Covariances(const GraphCovariance& covariance, double spacing_m) {
    for (const int pose : NodesForCovariance(block_, spacing_m)) {
      covariance_of_[pose] = covariance.OfPose(pose);
      solution_.covariances.push_back(
          {block_.nodes[static_cast<std::size_t>(pose) - block_.num_submaps], covariance_of_[pose]});
    }
  }

  // `tied`: of each mark; empty in the local frame.
  void Marks(const std::vector<TiedMark>& tied) {
    for (std::size_t i = 0; i < track_.marks.size(); ++i) {
      const TrackedMark& tracked = track_.marks[i];
      SolvedMark mark{
          .point = tracked.point, .start_ns = tracked.start_ns, .end_ns = tracked.end_ns, .scan = tracked.scan};
      mark.position_in_site = MarkPosition(block_.graph, block_.graph.marks[i]) + offset_;
      mark.covariance = PositionCovariance(block_.graph.marks[i]);
      if (!tied.empty() && tied[i].on_control) {
        mark.used = tied[i].used;
        mark.left_out = tied[i].left_out;
        mark.test = tied[i].test;
        mark.residual = mark.position_in_site - tied[i].given;
        mark.rigid_residual = tied[i].rigid - tied[i].given;
      }
      solution_.marks.push_back(std::move(mark));
    }
  }

 private:
  Pose2 InSite(const Pose2& pose) const { return {pose.x + offset_.x(), pose.y + offset_.y(), pose.theta}; }

  Eigen::Matrix2d PositionCovariance(const MarkEdge& edge) const {
    const auto found = covariance_of_.find(edge.pose);
    if (found == covariance_of_.end()) return Eigen::Matrix2d::Zero();
    return CovarianceOfMark(edge, block_.graph.poses[static_cast<std::size_t>(edge.pose)], found->second);
  }

  const Track& track_;
  const BlockGraph& block_;
  Eigen::Vector2d offset_;
  Solution& solution_;
  std::map<int, Eigen::Matrix3d> covariance_of_;
};

BlockAdjustment Failed(std::string message) { return {.usable = false, .message = std::move(message), .solution = {}}; }

// The relative observations by kind, and control. The track counts by what others bent it by.
std::vector<VarianceComponent> Components(const PoseGraph& graph, const KindEvidence& alone,
                                          const GraphCovariance& covariance, const VarianceComponent& control) {
  std::vector<VarianceComponent> components;
  const auto add = [&](const char* kind, std::initializer_list<EdgeKind> kinds, const KindEvidence& evidence) {
    const auto count = std::count_if(graph.edges.begin(), graph.edges.end(), [&](const PoseEdge& edge) {
      return std::find(kinds.begin(), kinds.end(), edge.kind) != kinds.end();
    });
    if (count > 0) components.push_back({kind, static_cast<int>(count), evidence.redundancy, evidence.Factor()});
  };
  const auto track = {EdgeKind::kScanMatch, EdgeKind::kMotion};
  add("track", track, Beyond(EvidenceOf(graph, covariance, track), alone));
  add("loop", {EdgeKind::kLoop}, EvidenceOf(graph, covariance, {EdgeKind::kLoop}));
  add("answer", {EdgeKind::kAnswer}, EvidenceOf(graph, covariance, {EdgeKind::kAnswer}));
  if (control.count > 0) components.push_back(control);
  return components;
}

// Memberships and motions agree with each other whatever their errors: their own conditions test nothing.
AdjustmentStatistics Statistics(const BlockGraph& block, const PoseGraphSummary& summary, const KindEvidence& alone) {
  AdjustmentStatistics statistics;
  statistics.num_nodes = static_cast<int>(block.nodes.size());
  statistics.num_submaps = static_cast<int>(block.num_submaps);
  const auto count = [&](EdgeKind kind) {
    return static_cast<int>(std::count_if(block.graph.edges.begin(), block.graph.edges.end(),
                                          [kind](const PoseEdge& edge) { return edge.kind == kind; }));
  };
  statistics.num_loops = count(EdgeKind::kLoop);
  statistics.num_track_constraints = count(EdgeKind::kScanMatch) + count(EdgeKind::kMotion);
  statistics.degrees_of_freedom = DegreesOfFreedom(block.graph) - static_cast<int>(std::lround(alone.redundancy));
  statistics.iterations = summary.iterations;
  statistics.initial_cost = summary.initial_cost;
  statistics.final_cost = summary.final_cost;
  if (statistics.degrees_of_freedom > 0)
    statistics.sigma_zero =
        std::sqrt(std::max(0.0, 2.0 * summary.final_cost - alone.squares) / statistics.degrees_of_freedom);
  return statistics;
}

// The adjustment in its order: free, with answers, with control, with answers in the site frame. Steps return false
// with a message.
class Adjuster {
 public:
  Adjuster(const Track& track, const Loops& loops, const ControlNetwork& control, const std::vector<StampNs>& stamps,
           const BlockAdjustmentOptions& options, const Answers& answers)
      : track_(track),
        control_(control),
        stamps_(stamps),
        options_(options),
        answers_(answers),
        block_(MakeBlockGraph(track, loops)),
        points_(MarkedControl(control, block_)) {}

  BlockAdjustment Run() {
    if (!Free() || !WithAnswers() || !WithControl() || !WithSiteAnswers()) return Failed(message_);
    Write();
    if (!message_.empty()) return Failed(message_);
    result_.graph = MakeControlledGraph(std::move(block_), tie_.offset);
    result_.usable = true;
    return std::move(result_);
  }

 private:
  bool Fail(const std::string& message) {
    message_ = message;
    return false;
  }

  bool Free() {
    free_ = SolveFree(options_.tie.solver, &block_.graph);
    summary_ = free_.summary;
    result_.factors = free_.factors;
    return summary_.usable || Fail("the free adjustment did not converge: " + summary_.message);
  }

  // Answers come with their own sigmas: the variance factor is not theirs.
  bool WithAnswers() {
    const std::string impossible = ProblemWithWalls(answers_, PosesOfAllScans(track_, block_, stamps_));
    if (!impossible.empty()) return Fail(impossible);
    first_answer_ = AddAnswers(track_, answers_, &block_);
    if (std::none_of(answers_.begin(), answers_.end(), [](const Answer& a) { return a.ActsInLocalFrame(); }))
      return true;
    const std::vector<Pose2> free_poses = block_.graph.poses;
    if (!SolveAgain()) return false;
    const auto freed =
        FollowAnswersAgainstLoops(first_answer_, free_poses, result_.factors.loops, options_.tie.solver, &block_);
    if (!freed) return true;
    summary_ = freed->summary;
    loops_left_out_ = freed->loops_left_out;
    first_answer_ -= loops_left_out_;
    return true;
  }

  bool SolveAgain() {
    summary_ = Solve(&block_.graph, options_.tie.solver);
    return summary_.usable || Fail("the adjustment with answers did not converge: " + summary_.message);
  }

  bool WithControl() {
    Solution& solution = result_.solution;
    solution.tied = !points_.empty();
    if (!solution.tied) return true;
    if (points_.size() == 1 && !options_.allow_single_point) {
      return Fail("the block's marks.csv stands on one control point only, " + points_.front()->name +
                  ": it fixes the place but not the direction; mark a second one, or set allow-single-point = true "
                  "under [adjust] in block.toml");
    }
    Tie();
    if (!tie_.usable) return Fail(tie_.message);
    solution.frame = control_.frame;
    solution.site_from_local = tie_.site_from_local;
    solution.rigid_scale = 1.0 + tie_.verdict.scale_deviation;
    solution.control = tie_.verdict;
    solution.findings = tie_.findings;
    return true;
  }

  void Tie() {
    if (points_.size() == 1) {
      tie_ = ShiftOntoPoint(*points_.front(), &block_);
      return;
    }
    const double free_sigma_zero = Statistics(block_, summary_, free_.alone).sigma_zero;
    FreezeRobustWeights(&block_.graph);
    tie_ = TieToControl(control_, options_.tie, free_.factors, MotionOfTrack(track_, stamps_), &block_);
    tie_.verdict.free_sigma_zero = free_sigma_zero;
    result_.factors.track *= tie_.network_factor;
    result_.factors.loops *= tie_.network_factor;
    free_.alone.squares /= tie_.network_factor;
    summary_ = tie_.summary;
  }

  bool WithSiteAnswers() {
    if (std::none_of(answers_.begin(), answers_.end(), [](const Answer& answer) { return answer.site_from_scan; }))
      return true;
    if (points_.size() < 2) {
      result_.answers = UnusedSiteAnswers(answers_);
      return true;
    }
    const auto covariance = GraphCovariance::Of(block_.graph);
    if (!covariance) return true;
    const std::size_t first = block_.graph.edges.size();
    const std::vector<AnswerTest> left_out =
        AddSiteAnswers(track_, answers_, {tie_.offset, ScansOnControl()}, *covariance, &block_);
    if (block_.graph.edges.size() > first && !SolveAgain()) return false;
    result_.answers = TestSiteAnswers(answers_, left_out, block_, first);
    return true;
  }

  std::vector<ScanId> ScansOnControl() const {
    std::vector<ScanId> scans;
    for (std::size_t i = 0; i < track_.marks.size(); ++i) {
      if (tie_.marks[i].used) scans.push_back(track_.marks[i].scan);
    }
    return scans;
  }

  void Write() {
    Solution& solution = result_.solution;
    solution.navigation = track_.navigation;
    solution.breaks = BreaksOf(track_);
    Writer writer(track_, block_, tie_.offset, &solution);
    writer.Poses(stamps_);
    if (const auto covariance = GraphCovariance::Of(block_.graph)) {
      writer.Covariances(*covariance, options_.covariance_spacing_m);
      solution.components = Components(block_.graph, free_.alone, *covariance, tie_.of_control);
    }
    writer.Marks(tie_.marks);
    solution.statistics = Statistics(block_, summary_, free_.alone);
    solution.statistics.num_control_marks = static_cast<int>(
        std::count_if(solution.marks.begin(), solution.marks.end(), [](const SolvedMark& mark) { return mark.used; }));
    ReportAnswers();
  }

  void ReportAnswers() {
    const std::vector<AnswerTest> others = TestAnswers(answers_, block_, first_answer_, options_.tie.solver);
    result_.answers.insert(result_.answers.end(), others.begin(), others.end());
    for (const AnswerTest& test : result_.answers) {
      if (const std::string sentence = SentenceOn(test); !sentence.empty())
        result_.solution.findings.push_back(sentence);
    }
    if (loops_left_out_ > 0)
      result_.solution.findings.push_back(std::to_string(loops_left_out_) +
                                          " loops contradict answers that agree with each other and were left out");
    if (points_.size() > 1) message_ = AnswerOutsideMap(answers_, result_.solution.scans);
  }

  const Track& track_;
  const ControlNetwork& control_;
  const std::vector<StampNs>& stamps_;
  const BlockAdjustmentOptions& options_;
  const Answers& answers_;
  BlockGraph block_;
  std::vector<const ControlPoint*> points_;  // control that is marked in the block
  FreeSolution free_;
  PoseGraphSummary summary_;
  std::size_t first_answer_ = 0;
  std::size_t loops_left_out_ = 0;
  ControlTie tie_;
  std::string message_;
  BlockAdjustment result_;
};

}  // namespace

BlockAdjustment AdjustBlock(const Track& track, const Loops& loops, const ControlNetwork& control,
                            const std::vector<StampNs>& stamps, const BlockAdjustmentOptions& options,
                            const Answers& answers) {
  if (track.submaps.empty()) return Failed("the track has no submap");
  return Adjuster(track, loops, control, stamps, options, answers).Run();
}

}  // namespace survey
