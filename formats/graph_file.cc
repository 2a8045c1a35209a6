// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "formats/artefact_file.h"
#include "formats/artefacts.h"
#include "formats/errors.h"

namespace formats {
namespace {

using survey::EdgeKind;
constexpr EdgeKind kEdgeKinds[] = {EdgeKind::kScanMatch, EdgeKind::kMotion, EdgeKind::kLoop, EdgeKind::kAnswer};

struct GraphPose {
  survey::ScanId scan;  // -1: a submap
  survey::Pose2 pose;
};
struct GraphPoint {
  std::string name;  // empty: the place of a mark that was left out
  bool control = false;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
};

constexpr auto kPoseRow = [](auto& row, auto& id, auto& pose) { row(id, pose.scan, pose.pose); };
constexpr auto kPointRow = [](auto& row, auto& id, auto& point) { row(id, point.name, point.control, point.place); };
constexpr auto kMarkRow = [](auto& row, auto& id, auto& mark) {
  row(id, mark.pose, mark.point, mark.p_in_pose, mark.covariance);
};
constexpr auto kEdgeRow = [](auto& row, auto& id, auto& edge) {
  row(id, Named(edge.kind, kEdgeKinds), edge.base, edge.target, edge.base_from_target, edge.covariance);
};

std::vector<GraphPose> PosesOf(const survey::BlockGraph& block) {
  std::vector<GraphPose> poses;
  for (const survey::Pose2& pose : block.graph.poses) {
    const std::size_t index = poses.size();
    poses.push_back({index < block.num_submaps ? survey::ScanId{} : block.nodes[index - block.num_submaps], pose});
  }
  return poses;
}

std::vector<GraphPoint> PointsOf(const survey::ControlledGraph& graph) {
  std::vector<GraphPoint> points;
  for (const Eigen::Vector2d& place : graph.block.graph.points) {
    const bool named = points.size() < graph.block.point_names.size();
    const std::string name = named ? graph.block.point_names[points.size()] : "";
    points.push_back({name, std::binary_search(graph.control.begin(), graph.control.end(), name), place});
  }
  return points;
}

void TakePoses(const std::filesystem::path& file, const std::vector<GraphPose>& poses, survey::BlockGraph* block) {
  for (const GraphPose& pose : poses) {
    const bool submap = pose.scan.value < 0;
    const bool in_order = submap ? block->nodes.empty() : block->nodes.empty() || block->nodes.back() < pose.scan;
    if (!in_order) throw DataError(file.string() + ": table poses: submaps must come first, then scans in order");
    if (submap) {
      ++block->num_submaps;
    } else {
      block->nodes.push_back(pose.scan);
    }
    block->graph.poses.push_back(pose.pose);
  }
}

}  // namespace

void WriteGraph(const std::filesystem::path& file, const survey::ControlledGraph& graph, const Provenance& provenance) {
  ArtefactWriter writer(file, ArtefactKind::kGraph, provenance);
  WriteRows(writer, "poses", PosesOf(graph.block), kPoseRow);
  WriteRows(writer, "points", PointsOf(graph), kPointRow);
  WriteRows(writer, "marks", graph.block.graph.marks, kMarkRow);
  WriteRows(writer, "edges", graph.block.graph.edges, kEdgeRow);
  writer.Commit();
}

survey::ControlledGraph ReadGraph(const std::filesystem::path& file) {
  ArtefactReader reader(file, ArtefactKind::kGraph);
  survey::ControlledGraph graph;
  TakePoses(file, ReadRows<GraphPose>(reader, "poses", kPoseRow), &graph.block);
  for (const GraphPoint& point : ReadRows<GraphPoint>(reader, "points", kPointRow)) {
    graph.block.graph.points.push_back(point.place);
    if (!point.name.empty()) graph.block.point_names.push_back(point.name);
    if (point.control) graph.control.push_back(point.name);
  }
  graph.block.graph.marks = ReadRows<survey::MarkEdge>(reader, "marks", kMarkRow);
  graph.block.graph.edges = ReadRows<survey::PoseEdge>(reader, "edges", kEdgeRow);
  return graph;
}

}  // namespace formats
