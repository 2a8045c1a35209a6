// SPDX-License-Identifier: Apache-2.0
#include "tests/support/garage_block.h"

#include <Eigen/Dense>
#include <cmath>

#include "survey/graph/graph_covariance.h"
#include "survey/graph/variance_components.h"
#include "survey/stats/philox.h"

namespace test_support {
namespace {

using survey::Between;
using survey::Pose2;

constexpr survey::Pose2 kSiteFromWorld{500100.0, 5600200.0, 0.9};
constexpr double kMotionSigma_m = 0.012;  // per metre
constexpr double kMotionSigma_rad = 0.002;
constexpr double kLoopSigma_m = 0.02;
constexpr double kLoopSigma_rad = 0.003;
constexpr double kMarkSigma_m = 0.005;
constexpr double kOwnSigma_m = 0.003;     // of a control point
constexpr double kCommonSigma_m = 0.002;  // that all control points share

enum Purpose : std::uint32_t { kMotion, kLoop, kMark, kControl, kChoice };

// Metre by metre along three aisles and back; two laps.
std::vector<Pose2> Laps() {
  const std::vector<Eigen::Vector2d> corners = {{0, 0},   {40, 0},  {40, 12}, {4, 12}, {4, 24},
                                                {44, 24}, {44, -4}, {0, -4},  {0, 0}};
  std::vector<Pose2> poses;
  for (int lap = 0; lap < 2; ++lap) {
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      const Eigen::Vector2d way = corners[k + 1] - corners[k];
      const double heading = std::atan2(way.y(), way.x());
      for (int i = 0; i < static_cast<int>(way.norm()); ++i) {
        const Eigen::Vector2d p = corners[k] + way.normalized() * i;
        poses.push_back({p.x(), p.y(), heading});
      }
    }
  }
  return poses;
}

Eigen::Matrix3d PoseCovariance(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

Pose2 WithError(const Pose2& pose, const survey::RandomStream& noise, std::size_t index, double sigma_m,
                double sigma_rad) {
  const auto [x, y] = noise.Normals(2 * index);
  return {pose.x + sigma_m * x, pose.y + sigma_m * y, pose.theta + sigma_rad * noise.Normal(2 * index + 1)};
}

void AddMotions(std::uint32_t seed, double errors, const std::vector<Pose2>& truth, survey::PoseGraph* graph) {
  const survey::RandomStream noise(seed, kMotion, 1);
  graph->poses.push_back({});
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose2 motion =
        WithError(Between(truth[i - 1], truth[i]), noise, i, errors * kMotionSigma_m, errors * kMotionSigma_rad);
    graph->edges.push_back({static_cast<int>(i) - 1, static_cast<int>(i), motion,
                            PoseCovariance(kMotionSigma_m, kMotionSigma_rad), false, survey::EdgeKind::kMotion});
    graph->poses.push_back(graph->poses.back() * motion);
  }
}

// Every third metre of the second lap sees the first one.
void AddLoops(std::uint32_t seed, const std::vector<Pose2>& truth, survey::PoseGraph* graph) {
  const survey::RandomStream noise(seed, kLoop, 1);
  const std::size_t lap = truth.size() / 2;
  for (std::size_t i = lap; i < truth.size(); i += 3) {
    const std::size_t base = i - lap;
    graph->edges.push_back({static_cast<int>(base), static_cast<int>(i),
                            WithError(Between(truth[base], truth[i]), noise, i, kLoopSigma_m, kLoopSigma_rad),
                            PoseCovariance(kLoopSigma_m, kLoopSigma_rad), true, survey::EdgeKind::kLoop});
  }
}

// A marked point every 19 m of the first lap.
void AddMarks(std::uint32_t seed, const std::vector<Pose2>& truth, GarageBlock* garage) {
  const survey::RandomStream noise(seed, kMark, 1);
  survey::PoseGraph& graph = garage->block.graph;
  for (std::size_t i = 7; i < truth.size() / 2; i += 19) {
    const auto [x, y] = noise.Normals(i);
    const int point = static_cast<int>(graph.points.size());
    graph.marks.push_back({static_cast<int>(i), point, kMarkSigma_m * Eigen::Vector2d(x, y),
                           kMarkSigma_m * kMarkSigma_m * Eigen::Matrix2d::Identity()});
    graph.points.push_back(graph.poses[i].Translation());
    garage->block.point_names.push_back("C" + std::to_string(100 + point));
  }
}

void SurveyControl(std::uint32_t seed, GarageBlock* garage) {
  const survey::RandomStream noise(seed, kControl, 1);
  const auto error = [&](std::uint64_t index, double sigma) {
    const auto [x, y] = noise.Normals(index);
    return Eigen::Vector2d(sigma * x, sigma * y);
  };
  const Eigen::Vector2d common = error(0, kCommonSigma_m);
  const Eigen::Matrix2d shared = kCommonSigma_m * kCommonSigma_m * Eigen::Matrix2d::Identity();
  for (std::size_t i = 0; i < garage->num_marks(); ++i) {
    survey::ControlPoint point{.name = garage->block.point_names[i]};
    const auto pose = static_cast<std::size_t>(garage->block.graph.marks[i].pose);
    point.position_in_site = garage->site_from_pose[pose].Translation() + common + error(i + 1, kOwnSigma_m);
    point.covariance = shared + kOwnSigma_m * kOwnSigma_m * Eigen::Matrix2d::Identity();
    garage->control.points.push_back(point);
    for (std::size_t j = 0; j < i; ++j)
      garage->control.correlations.push_back({static_cast<int>(j), static_cast<int>(i), shared});
  }
}

// Every 60 m of the way after the adjustment.
struct EllipseCounts {
  int ellipses = 0;
  int inside = 0;
  double squared_error = 0.0;
  double variance = 0.0;
};

EllipseCounts CountEllipses(const GarageBlock& garage, const survey::ControlTie& tie) {
  EllipseCounts counts;
  const auto covariance = survey::GraphCovariance::Of(garage.block.graph);
  for (std::size_t i = 10; i < garage.site_from_pose.size(); i += 60) {
    const Eigen::Vector2d error =
        garage.block.graph.poses[i].Translation() + tie.offset - garage.site_from_pose[i].Translation();
    const Eigen::Matrix2d ellipse = covariance->OfPose(static_cast<int>(i)).topLeftCorner<2, 2>();
    ++counts.ellipses;
    if (error.dot(ellipse.inverse() * error) <= survey::CriticalT(0.05, 2)) ++counts.inside;
    counts.squared_error += error.squaredNorm();
    counts.variance += ellipse.trace();
  }
  return counts;
}

bool LostAMark(const survey::ControlTie& tie) {
  return std::any_of(tie.marks.begin(), tie.marks.end(), [](const survey::TiedMark& mark) { return !mark.used; });
}

void CountClean(const GarageBlock& clean, ReliabilityCounts* counts, std::vector<survey::MarkTest>* tests) {
  GarageBlock garage = clean;
  const survey::ControlTie tie = TieGarageBlock(&garage);
  for (const survey::TiedMark& mark : tie.marks) {
    tests->push_back(*mark.test);
    ++counts->marks_tested;
    if (mark.test->t > tie.verdict.critical_t) ++counts->false_alarms;
  }
  if (LostAMark(tie)) ++counts->clean_rejected;
  const EllipseCounts of_block = CountEllipses(garage, tie);
  counts->ellipses += of_block.ellipses;
  counts->inside += of_block.inside;
}

// Sigmas that are ten times too large are what tracks start with (docs/reliability.md).
void CountWithoutLoops(std::uint32_t seed, ReliabilityCounts* counts) {
  GarageBlock garage = SimulateGarageBlock(seed, 0.1);
  std::erase_if(garage.block.graph.edges, [](const auto& edge) { return edge.kind == survey::EdgeKind::kLoop; });
  const survey::ControlTie tie = AdjustGarageBlock(&garage);
  if (LostAMark(tie)) ++counts->unlooped_rejected;
  const EllipseCounts of_block = CountEllipses(garage, tie);
  counts->unlooped_inside += of_block.inside;
  counts->unlooped_squared_error += of_block.squared_error;
  counts->unlooped_variance += of_block.variance;
}

bool OnlyLeftOut(const survey::ControlTie& tie, const std::vector<std::size_t>& marks) {
  for (std::size_t i = 0; i < tie.marks.size(); ++i) {
    const bool wanted = std::find(marks.begin(), marks.end(), i) != marks.end();
    if (tie.marks[i].used == wanted) return false;
  }
  return true;
}

bool BlunderIsNamed(const GarageBlock& clean, std::size_t mark, double size, double direction) {
  GarageBlock garage = clean;
  garage.PointOfMark(mark).position_in_site += size * Eigen::Vector2d(std::cos(direction), std::sin(direction));
  return OnlyLeftOut(TieGarageBlock(&garage), {mark});
}

void CountExchange(const GarageBlock& clean, std::size_t a, std::size_t b, ReliabilityCounts* counts) {
  GarageBlock garage = clean;
  std::swap(garage.PointOfMark(a).position_in_site, garage.PointOfMark(b).position_in_site);
  const survey::ControlTie tie = TieGarageBlock(&garage);
  const auto names = [&](const std::string& sentence) {
    return sentence.find("look exchanged") != std::string::npos &&
           sentence.find(garage.PointOfMark(a).name) != std::string::npos &&
           sentence.find(garage.PointOfMark(b).name) != std::string::npos;
  };
  if (!names(tie.marks[a].left_out) || !names(tie.marks[b].left_out)) return;
  ++counts->exchanges_named;
  if (OnlyLeftOut(tie, {a, b})) ++counts->exchanges_alone;
}

void CountTime(const GarageBlock& clean, std::size_t mark, ReliabilityCounts* counts) {
  GarageBlock garage = clean;
  garage.block.graph.marks[mark].p_in_pose.x() -= 0.5 * kGarageSpeed_m_s;
  const survey::ControlTie tie = TieGarageBlock(&garage);
  if (!OnlyLeftOut(tie, {mark})) return;
  ++counts->times_found;
  const std::string& sentence = tie.marks[mark].left_out;
  for (const char* time : {"fit 0.4 s later", "fit 0.5 s later", "fit 0.6 s later"}) {
    if (sentence.find(time) != std::string::npos) ++counts->times_named;
  }
}

}  // namespace

survey::ControlPoint& GarageBlock::PointOfMark(std::size_t mark) {
  return control.points[static_cast<std::size_t>(block.graph.marks[mark].point)];
}

GarageBlock SimulateGarageBlock(std::uint32_t seed, double motion_errors) {
  const std::vector<Pose2> truth = Laps();
  GarageBlock garage;
  for (const Pose2& pose : truth) garage.site_from_pose.push_back(kSiteFromWorld * pose);
  AddMotions(seed, motion_errors, truth, &garage.block.graph);
  AddLoops(seed, truth, &garage.block.graph);
  AddMarks(seed, truth, &garage);
  SurveyControl(seed, &garage);
  garage.block.graph.fixed_pose = 0;
  return garage;
}

void SolveGarageBlockFree(GarageBlock* garage) {
  garage->factors = survey::SolveFree({}, &garage->block.graph).factors;
  survey::FreezeRobustWeights(&garage->block.graph);
}

survey::ControlTie TieGarageBlock(GarageBlock* garage) {
  return survey::TieToControl(
      garage->control, {}, garage->factors,
      [](std::size_t, double seconds) { return Eigen::Vector2d(kGarageSpeed_m_s * seconds, 0.0); }, &garage->block);
}

survey::ControlTie AdjustGarageBlock(GarageBlock* garage) {
  SolveGarageBlockFree(garage);
  return TieGarageBlock(garage);
}

ReliabilityCounts CountReliability(std::uint32_t first_seed, int runs) {
  ReliabilityCounts counts;
  for (int run = 0; run < runs; ++run) {
    const std::uint32_t seed = first_seed + static_cast<std::uint32_t>(run);
    GarageBlock clean = SimulateGarageBlock(seed);
    SolveGarageBlockFree(&clean);
    std::vector<survey::MarkTest> tests;
    CountClean(clean, &counts, &tests);
    ++counts.runs;
    const survey::RandomStream choice(seed, kChoice, 1);
    const auto chosen = [&](std::uint64_t index) {
      return static_cast<std::size_t>(choice.Uniform(index) * static_cast<double>(clean.num_marks()));
    };
    const std::size_t mark = chosen(0);
    const double size = 3.0 * tests[mark].detectable.value();
    if (BlunderIsNamed(clean, mark, size, choice.Uniform(1, 0.0, 6.28))) ++counts.blunders_named;
    const std::size_t other = (mark + 1 + chosen(2) % (clean.num_marks() - 1)) % clean.num_marks();
    CountExchange(clean, mark, other, &counts);
    CountTime(clean, chosen(3), &counts);
    CountWithoutLoops(seed, &counts);
  }
  return counts;
}

}  // namespace test_support
