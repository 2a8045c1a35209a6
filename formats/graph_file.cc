// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"
#include "formats/errors.h"

namespace formats {
namespace {

using survey::EdgeKind;
constexpr EdgeKind kEdgeKinds[] = {EdgeKind::kScanMatch, EdgeKind::kMotion, EdgeKind::kLoop, EdgeKind::kAnswer};

constexpr survey::WallRelation kRelations[] = {survey::WallRelation::kCollinear, survey::WallRelation::kParallel,
                                               survey::WallRelation::kPerpendicular};
constexpr survey::ScanId kSubmap{-1};
constexpr survey::ScanId kSite{-2};

struct GraphPose {
  survey::ScanId scan;
  survey::Pose2 pose;
};
struct GraphPoint {
  std::string name;  // empty: the place of a mark that was left out
  bool control = false;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  std::optional<double> given_x, given_y, given_sigma;
};

constexpr auto kPoseRow = [](auto& row, auto& id, auto& pose) { row(id, pose.scan, pose.pose); };
constexpr auto kPointRow = [](auto& row, auto& id, auto& point) {
  row(id, point.name, point.control, point.place, point.given_x, point.given_y, point.given_sigma);
};
constexpr auto kMarkRow = [](auto& row, auto& id, auto& mark) {
  row(id, mark.pose, mark.point, mark.p_in_pose, mark.covariance);
};
constexpr auto kEdgeRow = [](auto& row, auto& id, auto& edge) {
  row(id, Named(edge.kind, kEdgeKinds), edge.base, edge.target, edge.base_from_target, edge.covariance);
};
constexpr auto kWallRow = [](auto& row, auto& id, auto& edge) {
  auto& walls = edge.walls;
  row(id, Named(walls.relation, kRelations), edge.base, edge.target, walls.in_base.a, walls.in_base.b,
      walls.in_target.a, walls.in_target.b, edge.sigma);
};

std::vector<GraphPose> PosesOf(const survey::ControlledGraph& graph) {
  const survey::BlockGraph& block = graph.block;
  std::vector<GraphPose> poses;
  for (std::size_t i = 0; i < block.num_submaps; ++i) poses.push_back({kSubmap, block.graph.poses[i]});
  for (const survey::ScanId node : block.nodes) poses.push_back({node, block.graph.poses[poses.size()]});
  if (graph.site_pose) poses.push_back({kSite, block.graph.poses.back()});
  return poses;
}

std::vector<GraphPoint> PointsOf(const survey::ControlledGraph& graph) {
  std::vector<GraphPoint> points;
  for (const Eigen::Vector2d& place : graph.block.graph.points) {
    const bool named = points.size() < graph.block.point_names.size();
    const std::string name = named ? graph.block.point_names[points.size()] : "";
    points.push_back({name, std::binary_search(graph.control.begin(), graph.control.end(), name), place, {}, {}, {}});
  }
  for (const survey::GivenCoordinates& given : graph.block.graph.given) {
    GraphPoint& point = points[static_cast<std::size_t>(given.points.front())];
    point.given_x = given.coordinates.x();
    point.given_y = given.coordinates.y();
    point.given_sigma = std::sqrt(given.covariance(0, 0));
  }
  return points;
}

void TakePoses(const std::filesystem::path& file, const std::vector<GraphPose>& poses, survey::ControlledGraph* graph) {
  survey::BlockGraph& block = graph->block;
  for (const GraphPose& pose : poses) {
    const bool first_of_kind = block.nodes.empty() && !graph->site_pose;
    const bool in_order = pose.scan == kSubmap ? first_of_kind
                          : pose.scan == kSite ? !graph->site_pose
                                               : !graph->site_pose && (first_of_kind || block.nodes.back() < pose.scan);
    if (!in_order) throw DataError(file.string() + ": table poses: submaps, then scans in order, then the site frame");
    if (pose.scan == kSubmap) ++block.num_submaps;
    if (pose.scan == kSite) graph->site_pose = static_cast<int>(block.graph.poses.size());
    if (pose.scan.value >= 0) block.nodes.push_back(pose.scan);
    block.graph.poses.push_back(pose.pose);
  }
}

}  // namespace

void WriteGraph(const std::filesystem::path& file, const survey::ControlledGraph& graph, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kGraph, provenance);
  WriteRows(writer, "poses", PosesOf(graph), kPoseRow);
  WriteRows(writer, "points", PointsOf(graph), kPointRow);
  WriteRows(writer, "marks", graph.block.graph.marks, kMarkRow);
  WriteRows(writer, "edges", graph.block.graph.edges, kEdgeRow);
  WriteRows(writer, "walls", graph.block.graph.walls, kWallRow);
  writer.Commit();
}

survey::ControlledGraph ReadGraph(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kGraph);
  survey::ControlledGraph graph;
  TakePoses(file, ReadRows<GraphPose>(reader, "poses", kPoseRow), &graph);
  for (const GraphPoint& point : ReadRows<GraphPoint>(reader, "points", kPointRow)) {
    graph.block.graph.points.push_back(point.place);
    if (!point.name.empty()) graph.block.point_names.push_back(point.name);
    if (point.control) graph.control.push_back(point.name);
    if (point.given_sigma) {
      const auto index = static_cast<int>(graph.block.graph.points.size()) - 1;
      graph.block.graph.given.push_back({{index},
                                         Eigen::Vector2d(*point.given_x, *point.given_y),
                                         std::pow(*point.given_sigma, 2) * Eigen::Matrix2d::Identity()});
    }
  }
  graph.block.graph.marks = ReadRows<survey::MarkEdge>(reader, "marks", kMarkRow);
  graph.block.graph.edges = ReadRows<survey::PoseEdge>(reader, "edges", kEdgeRow);
  graph.block.graph.walls = ReadRows<survey::WallEdge>(reader, "walls", kWallRow);
  return graph;
}

}  // namespace formats
