// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/control_tie.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "survey/geometry/rigid_fit.h"
#include "survey/graph/blunder_causes.h"
#include "survey/graph/blunder_search.h"
#include "survey/graph/control_misfit.h"
#include "survey/graph/control_tests.h"
#include "survey/graph/given_control.h"
#include "survey/graph/network_widening.h"

namespace survey {
namespace {

constexpr int kMaxRounds = 4;

Eigen::Vector2d PlaceOf(const PoseGraph& graph, const MarkEdge& mark) {
  return graph.poses[static_cast<std::size_t>(mark.pose)] * mark.p_in_pose;
}

class Tie {
 public:
  Tie(const ControlNetwork& control, const ControlTieOptions& options, const MotionInScan& motion, BlockGraph* block)
      : control_(control), options_(options), motion_(motion), block_(*block) {}

  ControlTie Run(const NetworkFactors& of_network) {
    if (!MoveToSite()) {
      result_.message = "the marked control points lie on one place: the direction of the block cannot be fixed";
      return std::move(result_);
    }
    const GivenControl all = GiveControl(control_, block_.point_names, {}, result_.offset);
    result_.message = all.problem;
    if (!all.problem.empty()) return std::move(result_);
    if (!of_network.told) WidenNetwork(all.given);
    if (!Iterate(all.given) || Mirrored()) return std::move(result_);
    if (!of_network.told && !RefineNetwork(all.given, of_network.conditions)) return std::move(result_);
    Report();
    block_.graph = std::move(constrained_);
    result_.usable = true;
    return std::move(result_);
  }

 private:
  const std::string& NameOf(const MarkEdge& mark) const {
    return block_.point_names[static_cast<std::size_t>(mark.point)];
  }

  // The free solution onto the marks, whatever blunders there are among them.
  bool MoveToSite() {
    PoseGraph& graph = block_.graph;
    result_.marks.resize(graph.marks.size());
    std::vector<Eigen::Vector2d> source, target;
    for (std::size_t i = 0; i < graph.marks.size(); ++i) {
      free_places_.push_back(PlaceOf(graph, graph.marks[i]));
      const auto point = std::find_if(control_.points.begin(), control_.points.end(), [&](const ControlPoint& each) {
        return each.role == PointRole::kControl && each.name == NameOf(graph.marks[i]);
      });
      if (point == control_.points.end()) continue;
      result_.marks[i].on_control = result_.marks[i].used = true;
      result_.marks[i].given = point->position_in_site;
      source.push_back(free_places_.back());
      target.push_back(point->position_in_site);
    }
    const std::optional<RigidFit> fit = FitRigidRobust(source, target);
    if (!fit) return false;
    Pose2 moved = fit->target_from_source;
    // Near zero the sums keep their digits; UTM northings would cost six of them.
    result_.offset = Eigen::Vector2d(std::round(moved.x), std::round(moved.y));
    moved.x -= result_.offset.x();
    moved.y -= result_.offset.y();
    for (Pose2& pose : graph.poses) pose = moved * pose;
    for (Eigen::Vector2d& point : graph.points) point = moved * point;
    return true;
  }

  void WidenNetwork(const std::vector<GivenCoordinates>& given) {
    const std::optional<ControlMisfit> misfit = MisfitOfControl(block_.graph, given);
    if (misfit) MultiplyCovariances(WideningFactor(*misfit));
  }

  // Of the sensors; people's answers have their own sigmas.
  void MultiplyCovariances(double factor) {
    for (PoseEdge& edge : block_.graph.edges) {
      if (edge.kind != EdgeKind::kAnswer) edge.covariance *= factor;
    }
    result_.network_factor *= factor;
  }

  // By the marks that were not left out; those that were stay so.
  bool RefineNetwork(const std::vector<GivenCoordinates>& given, double conditions) {
    if (search_.contradicted) return true;
    MultiplyCovariances(FactorByMarks(misfit_, search_.kept, conditions));
    misfit_ = *MisfitOfControl(block_.graph, given);
    return SolveConstrained();
  }

  // Search and adjustment until the search at the adjusted poses leaves out what was left out.
  bool Iterate(const std::vector<GivenCoordinates>& given) {
    std::set<int> left_out = {-1};
    for (int round = 0; round < kMaxRounds; ++round) {
      std::optional<ControlMisfit> misfit = MisfitOfControl(block_.graph, given);
      if (!misfit) {
        result_.message = "parts of the track hang together by nothing: the block cannot be adjusted";
        return false;
      }
      misfit_ = *std::move(misfit);
      search_ = SearchBlunders(misfit_, options_.family_significance);
      const std::set<int> now(search_.excluded.begin(), search_.excluded.end());
      if (now == left_out) break;
      left_out = now;
      if (!SolveConstrained()) return false;
    }
    return true;
  }

  // What was left out fits the mirror image of the block, as everything else does.
  bool Mirrored() {
    if (search_.excluded.empty() && !search_.contradicted) return false;
    std::vector<Eigen::Vector2d> source, target;
    for (std::size_t i = 0; i < result_.marks.size(); ++i) {
      if (!result_.marks[i].on_control) continue;
      source.push_back(free_places_[i]);
      target.push_back(result_.marks[i].given);
    }
    if (!FitsOnlyMirrored(source, target)) return false;
    result_.message =
        "the control points fit the block only as its mirror image: the lidar was upside down (give the beams' "
        "angle_increment the other sign), or northing and easting of the control are exchanged";
    return true;
  }

  bool SolveConstrained() {
    constrained_ = Constrained();
    result_.summary = Solve(&constrained_, options_.solver);
    if (!result_.summary.usable) {
      result_.message = "the adjustment with control did not converge: " + result_.summary.message;
      return false;
    }
    block_.graph.poses = constrained_.poses;
    std::copy_n(constrained_.points.begin(), block_.graph.points.size(), block_.graph.points.begin());
    return true;
  }

  // The graph with control; a mark that is left out hangs on a point of its own.
  PoseGraph Constrained() const {
    PoseGraph graph = block_.graph;
    std::set<std::string> unused(block_.point_names.begin(), block_.point_names.end());
    for (const int kept : search_.kept) unused.erase(NameOf(MarkAt(kept)));
    for (const int out : search_.excluded) {
      MarkEdge& mark = graph.marks[IndexOf(out)];
      if (unused.contains(NameOf(mark))) continue;  // its point goes as a whole
      graph.points.push_back(PlaceOf(graph, mark));
      mark.point = static_cast<int>(graph.points.size()) - 1;
    }
    graph.given = GiveControl(control_, block_.point_names, unused, result_.offset).given;
    for (const GivenCoordinates& group : graph.given) {
      for (std::size_t k = 0; k < group.points.size(); ++k) {
        graph.points[static_cast<std::size_t>(group.points[k])] =
            group.coordinates.segment<2>(2 * static_cast<Eigen::Index>(k));
      }
    }
    graph.fixed_pose.reset();
    return graph;
  }

  std::size_t IndexOf(int place) const {
    return static_cast<std::size_t>(misfit_.marks[static_cast<std::size_t>(place)]);
  }
  const MarkEdge& MarkAt(int place) const { return block_.graph.marks[IndexOf(place)]; }

  void Report() {
    const ControlTests tests(misfit_, search_.kept);
    FitRigidOnUsed();
    if (!tests.usable()) return;
    for (const int mark : search_.kept) result_.marks[IndexOf(mark)].test = TestOf(tests, mark);
    ReportVerdict(tests);
    ReportBlunders();
    const ControlTests::Component component = tests.ComponentOfControl();
    result_.of_control = {"control", static_cast<int>(search_.kept.size()), component.redundancy,
                          component.redundancy > 0.0 ? component.squares / component.redundancy : 0.0};
  }

  void FitRigidOnUsed() {
    for (const int out : search_.excluded) result_.marks[IndexOf(out)].used = false;
    std::vector<Eigen::Vector2d> source, target;
    for (std::size_t i = 0; i < result_.marks.size(); ++i) {
      if (!result_.marks[i].used) continue;
      source.push_back(free_places_[i]);
      target.push_back(result_.marks[i].given);
    }
    if (const auto fit = FitRigid(source, target)) {
      result_.site_from_local = fit->target_from_source;
      result_.verdict.rigid_rms = fit->rms_m;
    }
    for (std::size_t i = 0; i < result_.marks.size(); ++i)
      result_.marks[i].rigid = result_.site_from_local * free_places_[i];
  }

  MarkTest TestOf(const ControlTests& tests, int mark) const {
    const ErrorTest test = tests.Test(std::span(&mark, 1), options_.test);
    MarkTest result{.redundancy = tests.RedundancyOf(mark), .t = test.t, .degrees_of_freedom = test.degrees_of_freedom};
    if (!test.error) return result;
    result.left_out = -*test.error;
    result.left_out_covariance = test.covariance;
    result.detectable = test.minimal_detectable;
    if (std::isfinite(*test.minimal_detectable))
      result.largest_shift = tests.LargestShift(mark, *test.minimal_detectable * test.worst_direction);
    return result;
  }

  void ReportVerdict(const ControlTests& tests) {
    ControlVerdict& verdict = result_.verdict;
    verdict.chi_square = tests.chi_square();
    verdict.degrees_of_freedom = tests.degrees_of_freedom();
    verdict.chi_square_lower = CriticalT(0.975, verdict.degrees_of_freedom);
    verdict.chi_square_upper = CriticalT(0.025, verdict.degrees_of_freedom);
    verdict.critical_t = CriticalT(options_.test.significance, 2);
    verdict.rejection_t = search_.critical_t;
    verdict.contradicted = search_.contradicted;
    const ControlTests::Scale scale = tests.EstimateScale();
    verdict.scale_deviation = scale.deviation;
    verdict.scale_sigma = scale.sigma;
    if (search_.contradicted) {
      result_.findings.push_back(
          "control and map contradict each other, and too few points would be left to tell which of them are wrong: "
          "none was left out; check names, coordinates and the track");
    } else if (verdict.chi_square > verdict.chi_square_upper) {
      result_.findings.push_back("control fits the map worse than both sigmas allow (global test at 95 %)");
    }
    ReportScale();
  }

  void ReportScale() {
    const ControlVerdict& verdict = result_.verdict;
    if (!(std::abs(verdict.scale_deviation) > CriticalW(options_.test.significance) * verdict.scale_sigma)) return;
    char text[160];
    std::snprintf(text, sizeof text,
                  "the map's scale differs from that of the control by %+.0f ppm (sigma %.0f ppm): lidar, or grid and "
                  "ground distances mixed",
                  1e6 * verdict.scale_deviation, 1e6 * verdict.scale_sigma);
    result_.findings.push_back(text);
  }

  SuspectMark SuspectAt(int place, const MarkTest& test) const {
    const std::size_t index = IndexOf(place);
    const double heading = block_.graph.poses[static_cast<std::size_t>(MarkAt(place).pose)].theta;
    return {NameOf(MarkAt(place)),
            {result_.marks[index].given, -test.left_out, test.left_out_covariance},
            [this, index, heading](double seconds) -> std::optional<Eigen::Vector2d> {
              const auto moved = motion_ ? motion_(index, seconds) : std::nullopt;
              if (!moved) return std::nullopt;
              return Rotation2(heading) * *moved;
            }};
  }

  void ReportBlunders() {
    std::vector<SuspectMark> suspects;
    for (const int out : search_.excluded) {
      std::vector<int> with = search_.kept;
      with.insert(std::upper_bound(with.begin(), with.end(), out), out);
      result_.marks[IndexOf(out)].test = TestOf(ControlTests(misfit_, with), out);
      suspects.push_back(SuspectAt(out, *result_.marks[IndexOf(out)].test));
    }
    std::vector<std::pair<int, int>> exchanged;
    const auto order_of = [&](int mark) {
      return static_cast<int>(std::find(search_.excluded.begin(), search_.excluded.end(), mark) -
                              search_.excluded.begin());
    };
    for (const auto& [a, b] : search_.exchanged) exchanged.emplace_back(order_of(a), order_of(b));
    std::vector<NamedPlace> points;
    for (const ControlPoint& point : control_.points) {
      if (point.role == PointRole::kControl) points.push_back({point.name, point.position_in_site});
    }
    const std::vector<std::string> sentences = ExplainBlunders(suspects, exchanged, points);
    for (std::size_t i = 0; i < sentences.size(); ++i) {
      result_.marks[IndexOf(search_.excluded[i])].left_out = sentences[i];
      if (std::find(result_.findings.begin(), result_.findings.end(), sentences[i]) == result_.findings.end())
        result_.findings.push_back(sentences[i]);
    }
  }

  const ControlNetwork& control_;
  const ControlTieOptions& options_;
  const MotionInScan& motion_;
  BlockGraph& block_;
  std::vector<Eigen::Vector2d> free_places_;  // of the marks, local frame
  ControlMisfit misfit_;
  BlunderSearch search_;
  PoseGraph constrained_;
  ControlTie result_;
};

}  // namespace

ControlTie TieToControl(const ControlNetwork& control, const ControlTieOptions& options,
                        const NetworkFactors& of_network, const MotionInScan& motion, BlockGraph* block) {
  return Tie(control, options, motion, block).Run(of_network);
}

}  // namespace survey
