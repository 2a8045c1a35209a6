// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/site_answers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "survey/graph/graph_residuals.h"
#include "survey/stats/mahalanobis.h"

namespace survey {
namespace {

// What a track may be off against control, in the worst case, 1 sigma per metre of way.
constexpr double kDrift_m_per_m = 0.05;
constexpr double kDrift_rad_per_m = 0.02;

constexpr double kOutsideMap_m = 100.0;

const Pose2& Tracked(const Track& track, ScanId scan) {
  return track.scans[static_cast<std::size_t>(scan.value)].local_from_scan;
}

double WayBetween(const Track& track, ScanId a, ScanId b) {
  double way = 0.0;
  for (ScanId scan{std::min(a, b).value + 1}; !(std::max(a, b) < scan); ++scan.value)
    way += (Tracked(track, scan).Translation() - Tracked(track, {scan.value - 1}).Translation()).norm();
  return way;
}

double WayToControl(const Track& track, ScanId scan, const std::vector<ScanId>& on_control) {
  double nearest = std::numeric_limits<double>::max();
  for (const ScanId control : on_control) nearest = std::min(nearest, WayBetween(track, scan, control));
  return nearest;
}

// The pose of the scan's node that the answer means, in the frame of the graph.
Pose2 PoseOfNode(const Track& track, const Answer& answer, ScanId node, const Eigen::Vector2d& offset) {
  const Pose2& site_from_scan = *answer.site_from_scan;
  const Pose2 graph_from_scan{site_from_scan.x - offset.x(), site_from_scan.y - offset.y(), site_from_scan.theta};
  return graph_from_scan * Between(Tracked(track, answer.scan), Tracked(track, node));
}

AnswerTest AgainstControl(const Answer& answer, const PoseEdge& edge, double way, const GraphCovariance& covariance,
                          const PoseGraph& graph) {
  const RelativePoseResidual r =
      EvaluateRelativePose({}, graph.poses[static_cast<std::size_t>(edge.target)], edge.base_from_target);
  Eigen::Matrix3d sum = edge.covariance + covariance.OfPose(edge.target);
  const Eigen::Vector3d drift = way * Eigen::Vector3d(kDrift_m_per_m, kDrift_m_per_m, kDrift_rad_per_m);
  sum.diagonal() += drift.cwiseAbs2();
  return JudgeAnswer(answer, SquaredMahalanobis(r.error, sum), 3);
}

}  // namespace

std::vector<AnswerTest> AddSiteAnswers(const Track& track, const Answers& answers, const SiteDatum& datum,
                                       const GraphCovariance& covariance, BlockGraph* block) {
  PoseGraph& graph = block->graph;
  const auto site = static_cast<int>(graph.poses.size());
  std::vector<AnswerTest> left_out;
  std::vector<PoseEdge> edges;
  for (const Answer& answer : answers) {
    if (!answer.site_from_scan) continue;
    const ScanId node = NodeNear(*block, answer.scan);
    const PoseEdge edge{site,
                        block->PoseOf(node),
                        PoseOfNode(track, answer, node, datum.offset),
                        answer.sigma.cwiseAbs2().asDiagonal(),
                        false,
                        EdgeKind::kAnswer};
    AnswerTest test =
        AgainstControl(answer, edge, WayToControl(track, answer.scan, datum.on_control), covariance, graph);
    if (test.in_conflict) {
      test.not_used = "it contradicts the control";
      left_out.push_back(std::move(test));
    } else {
      edges.push_back(edge);
    }
  }
  if (edges.empty()) return left_out;
  graph.edges.insert(graph.edges.end(), edges.begin(), edges.end());
  graph.poses.emplace_back();
  graph.fixed_pose = site;
  return left_out;
}

std::vector<AnswerTest> TestSiteAnswers(const Answers& answers, const std::vector<AnswerTest>& left_out,
                                        const BlockGraph& block, std::size_t first_edge) {
  std::vector<AnswerTest> tests;
  for (const Answer& answer : answers) {
    if (!answer.site_from_scan) continue;
    const auto out = std::find_if(left_out.begin(), left_out.end(),
                                  [&](const AnswerTest& test) { return test.scan == answer.scan; });
    if (out != left_out.end()) {
      tests.push_back(*out);
    } else {
      tests.push_back(
          JudgeAnswer(answer, SquaredNormalisedResidual(block.graph.edges[first_edge++], block.graph.poses), 3));
    }
  }
  return tests;
}

std::vector<AnswerTest> UnusedSiteAnswers(const Answers& answers) {
  std::vector<AnswerTest> tests;
  for (const Answer& answer : answers) {
    if (!answer.site_from_scan) continue;
    tests.push_back({.name = answer.name,
                     .scan = answer.scan,
                     .not_used = "it is in the site frame, but two control points do not tie the block"});
  }
  return tests;
}

std::string AnswerOutsideMap(const Answers& answers, const std::vector<SolvedScan>& scans) {
  for (const Answer& answer : answers) {
    if (!answer.site_from_scan) continue;
    const Eigen::Vector2d place = answer.site_from_scan->Translation();
    const bool near = std::any_of(scans.begin(), scans.end(), [&](const SolvedScan& scan) {
      return (scan.site_from_scan.Translation() - place).norm() < kOutsideMap_m;
    });
    if (!near) return "answer " + answer.name + ": pose: outside the map: farther than 100 m from the way of the block";
  }
  return "";
}

}  // namespace survey
