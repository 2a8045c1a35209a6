// SPDX-License-Identifier: Apache-2.0
#include "tests/support/g2o_graph.h"

#include <zlib.h>

#include <Eigen/LU>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace test_support {
namespace {

std::string Unpacked(const std::filesystem::path& file) {
  const gzFile opened = gzopen(file.c_str(), "rb");
  if (opened == nullptr) throw std::runtime_error(file.string() + ": cannot be opened");
  std::string text;
  std::string buffer(1 << 16, '\0');
  int read = 0;
  while ((read = gzread(opened, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0)
    text.append(buffer, 0, static_cast<std::size_t>(read));
  gzclose(opened);
  if (read < 0) throw std::runtime_error(file.string() + ": is damaged");
  return text;
}

// The ends are ids of vertices.
survey::PoseEdge ReadEdge(std::istream* fields) {
  survey::PoseEdge edge;
  Eigen::Matrix3d information;
  *fields >> edge.base >> edge.target >> edge.base_from_target.x >> edge.base_from_target.y >>
      edge.base_from_target.theta;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      *fields >> information(i, j);
      information(j, i) = information(i, j);
    }
  }
  if (!*fields) throw std::runtime_error("an edge is not complete");
  edge.covariance = survey::RotatedCovariance(information.inverse(), edge.base_from_target.theta);
  return edge;
}

// Edges between neighbours in time first, then the shortest gaps.
void ChainPoses(survey::PoseGraph* graph) {
  std::vector<std::vector<std::size_t>> edges_of(graph->poses.size());
  for (std::size_t e = 0; e < graph->edges.size(); ++e) {
    edges_of[static_cast<std::size_t>(graph->edges[e].base)].push_back(e);
    edges_of[static_cast<std::size_t>(graph->edges[e].target)].push_back(e);
  }
  std::vector<bool> placed(graph->poses.size(), false);
  std::set<std::pair<int, std::size_t>> waiting;  // gap, edge
  const auto place = [&](int pose) {
    placed[static_cast<std::size_t>(pose)] = true;
    for (const std::size_t e : edges_of[static_cast<std::size_t>(pose)])
      waiting.emplace(std::abs(graph->edges[e].target - graph->edges[e].base), e);
  };
  place(0);
  while (!waiting.empty()) {
    const survey::PoseEdge& edge = graph->edges[waiting.begin()->second];
    waiting.erase(waiting.begin());
    survey::Pose2& base = graph->poses[static_cast<std::size_t>(edge.base)];
    survey::Pose2& target = graph->poses[static_cast<std::size_t>(edge.target)];
    if (!placed[static_cast<std::size_t>(edge.target)]) {
      target = base * edge.base_from_target;
      place(edge.target);
    } else if (!placed[static_cast<std::size_t>(edge.base)]) {
      base = target * survey::Inverse(edge.base_from_target);
      place(edge.base);
    }
  }
}

}  // namespace

survey::PoseGraph ReadG2o(const std::filesystem::path& file) {
  survey::PoseGraph graph;
  std::istringstream text(Unpacked(file));
  std::string line;
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::string tag;
    fields >> tag;
    if (tag == "EDGE_SE2") graph.edges.push_back(ReadEdge(&fields));
  }
  std::map<int, int> index_of;
  for (const survey::PoseEdge& edge : graph.edges) {
    index_of.emplace(edge.base, 0);
    index_of.emplace(edge.target, 0);
  }
  int count = 0;
  for (auto& [id, index] : index_of) index = count++;
  for (survey::PoseEdge& edge : graph.edges) {
    edge.base = index_of.at(edge.base);
    edge.target = index_of.at(edge.target);
  }
  graph.poses.resize(index_of.size());
  graph.fixed_pose = 0;
  ChainPoses(&graph);
  return graph;
}

}  // namespace test_support
