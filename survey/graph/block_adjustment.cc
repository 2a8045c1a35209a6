// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/block_adjustment.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "survey/graph/block_graph.h"
#include "survey/graph/control_tie.h"
#include "survey/graph/graph_covariance.h"
#include "survey/graph/variance_factor.h"

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

// Rows minus unknowns.
int DegreesOfFreedom(const PoseGraph& graph) {
  int dof = 3 * static_cast<int>(graph.edges.size()) + 2 * static_cast<int>(graph.marks.size()) -
            3 * static_cast<int>(graph.poses.size()) - 2 * static_cast<int>(graph.points.size()) +
            (graph.fixed_pose ? 3 : 0);
  for (const GivenCoordinates& given : graph.given) dof += 2 * static_cast<int>(given.points.size());
  return dof;
}

// Pose indices of the nodes whose covariances are wanted: every marked one and one per stretch of path.
std::vector<int> NodesForCovariance(const BlockGraph& block, double spacing_m) {
  std::vector<bool> marked(block.graph.poses.size(), false);
  for (const MarkEdge& mark : block.graph.marks) marked[static_cast<std::size_t>(mark.pose)] = true;
  std::vector<int> chosen;
  double way = spacing_m;
  for (std::size_t i = block.num_submaps; i < block.graph.poses.size(); ++i) {
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

// The relative observations by kind, and control.
std::vector<VarianceComponent> Components(const PoseGraph& graph, const GraphCovariance& covariance,
                                          const VarianceComponent& control) {
  std::vector<VarianceComponent> components = {
      {.kind = "scan match"}, {.kind = "motion"}, {.kind = "loop"}, {.kind = "answer"}};
  for (const PoseEdge& edge : graph.edges) {
    VarianceComponent& component = components[static_cast<std::size_t>(edge.kind)];
    ++component.count;
    component.redundancy += covariance.RedundancyOf(edge);
    component.factor += SquaredNormalisedResidual(edge, graph.poses);
  }
  std::erase_if(components, [](const VarianceComponent& component) { return component.count == 0; });
  for (VarianceComponent& component : components)
    component.factor = component.redundancy > 0.0 ? component.factor / component.redundancy : 0.0;
  if (control.count > 0) components.push_back(control);
  return components;
}

AdjustmentStatistics Statistics(const BlockGraph& block, const PoseGraphSummary& summary) {
  AdjustmentStatistics statistics;
  statistics.num_nodes = static_cast<int>(block.nodes.size());
  statistics.num_submaps = static_cast<int>(block.num_submaps);
  const auto count = [&](EdgeKind kind) {
    return static_cast<int>(std::count_if(block.graph.edges.begin(), block.graph.edges.end(),
                                          [kind](const PoseEdge& edge) { return edge.kind == kind; }));
  };
  statistics.num_loops = count(EdgeKind::kLoop);
  statistics.num_track_constraints = count(EdgeKind::kScanMatch) + count(EdgeKind::kMotion);
  statistics.degrees_of_freedom = DegreesOfFreedom(block.graph);
  statistics.iterations = summary.iterations;
  statistics.initial_cost = summary.initial_cost;
  statistics.final_cost = summary.final_cost;
  statistics.sigma_zero =
      statistics.degrees_of_freedom > 0 ? std::sqrt(2.0 * summary.final_cost / statistics.degrees_of_freedom) : 0.0;
  return statistics;
}

}  // namespace

BlockAdjustment AdjustBlock(const Track& track, const Loops& loops, const ControlNetwork& control,
                            const std::vector<StampNs>& stamps, const BlockAdjustmentOptions& options,
                            const Answers& answers) {
  if (track.submaps.empty()) return Failed("the track has no submap");
  BlockGraph block = MakeBlockGraph(track, loops);
  const FreeSolution free = SolveFree(options.tie.solver, &block.graph);
  PoseGraphSummary summary = free.summary;
  if (!summary.usable) return Failed("the free adjustment did not converge: " + summary.message);
  // Answers come with their own sigmas: the variance factor is not theirs.
  const std::size_t first_answer = AddAnswers(track, answers, &block);
  if (!answers.empty()) summary = Solve(&block.graph, options.tie.solver);
  if (!summary.usable) return Failed("the adjustment with answers did not converge: " + summary.message);

  const std::vector<const ControlPoint*> points = MarkedControl(control, block);
  if (points.size() == 1 && !options.allow_single_point) {
    return Failed("the block's marks.csv stands on one control point only, " + points.front()->name +
                  ": it fixes the place but not the direction; mark a second one, or set allow-single-point = true "
                  "under [adjust] in block.toml");
  }
  BlockAdjustment result;
  Solution& solution = result.solution;
  solution.tied = !points.empty();
  solution.navigation = track.navigation;
  solution.breaks = BreaksOf(track);
  ControlTie tie;
  if (solution.tied) {
    solution.frame = control.frame;
    if (points.size() == 1) {
      tie = ShiftOntoPoint(*points.front(), &block);
    } else {
      const double free_sigma_zero = Statistics(block, summary).sigma_zero;
      FreezeRobustWeights(&block.graph);
      tie = TieToControl(control, options.tie, free.factor, MotionOfTrack(track, stamps), &block);
      tie.verdict.free_sigma_zero = free_sigma_zero;
      summary = tie.summary;
    }
    if (!tie.usable) return Failed(tie.message);
    solution.site_from_local = tie.site_from_local;
    solution.rigid_scale = 1.0 + tie.verdict.scale_deviation;
    solution.control = tie.verdict;
    solution.findings = tie.findings;
  }

  Writer writer(track, block, tie.offset, &solution);
  writer.Poses(stamps);
  if (const auto covariance = GraphCovariance::Of(block.graph)) {
    writer.Covariances(*covariance, options.covariance_spacing_m);
    solution.components = Components(block.graph, *covariance, tie.of_control);
  }
  writer.Marks(tie.marks);
  solution.statistics = Statistics(block, summary);
  solution.statistics.num_control_marks = static_cast<int>(
      std::count_if(solution.marks.begin(), solution.marks.end(), [](const SolvedMark& mark) { return mark.used; }));
  result.answers = TestAnswers(answers, block, first_answer);
  result.graph = MakeControlledGraph(std::move(block), tie.offset);
  result.usable = true;
  return result;
}

}  // namespace survey
