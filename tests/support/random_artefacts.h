// SPDX-License-Identifier: Apache-2.0
//
// Artefacts with random content, for tests of their files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "formats/provenance.h"
#include "survey/control/control_point.h"
#include "survey/graph/controlled_graph.h"
#include "survey/graph/solution.h"
#include "survey/sensors/session.h"
#include "survey/submaps/track.h"

namespace test_support {

class RandomArtefacts {
 public:
  explicit RandomArtefacts(std::uint64_t seed) : engine_(seed) {}

  survey::Session Session(int num_scans, int num_beams);
  survey::NavigationSummary Navigation();
  survey::Track Track(int num_scans);
  survey::Loops Loops(int num_loops);
  survey::ControlNetwork Control(int num_points);
  survey::Solution Solution(int num_scans);
  survey::ControlledGraph Graph(int num_nodes);
  std::vector<survey::StampNs> Stamps(int count);
  std::vector<survey::ScanStamp> ScanStamps(int count);
  formats::Provenance Provenance(int num_ancestors);

  std::uint64_t Below(std::uint64_t limit) { return engine_() % limit; }
  bool Coin() { return Below(2) == 1; }
  double Real(double scale);  // any digits, both signs

 private:
  std::string Text();
  survey::Pose2 Pose();
  Eigen::Vector2d Vector2() { return {Real(1e7), Real(1e7)}; }
  template <int N>
  Eigen::Matrix<double, N, N> Covariance() {
    Eigen::Matrix<double, N, N> root;
    for (double& value : root.reshaped()) value = Real(1.0);
    const Eigen::Matrix<double, N, N> square = root * root.transpose();
    return square.template selfadjointView<Eigen::Upper>();
  }
  survey::SubmapConstraint Constraint(int num_submaps, int num_scans);

  std::mt19937_64 engine_;
};

// One small artefact of each kind: its name and how to write and to read it.
struct ArtefactCase {
  std::string name;
  std::function<void(const std::filesystem::path&)> write;
  std::function<void(const std::filesystem::path&)> read;                                // throws or not
  std::function<void(const std::filesystem::path&, const std::filesystem::path&)> copy;  // read, then write
};
std::vector<ArtefactCase> SmallArtefacts(std::uint64_t seed);

}  // namespace test_support
