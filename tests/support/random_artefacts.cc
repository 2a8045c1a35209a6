// SPDX-License-Identifier: Apache-2.0
#include "tests/support/random_artefacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/artefacts.h"
#include "formats/digest.h"

namespace test_support {
namespace {

survey::ScanId ScanIdOf(std::uint64_t value) { return {static_cast<int>(value)}; }

}  // namespace

double RandomArtefacts::Real(double scale) {
  const double fraction = static_cast<double>(engine_() >> 11) * 0x1p-53;
  return scale * (2.0 * fraction - 1.0);
}

std::string RandomArtefacts::Text() {
  static const std::vector<std::string> kPieces = {"P", "7", " ", "'", "\"", ";", "\n", "\xc3\xa4", "%", "\\", "--"};
  std::string text = "x";
  for (std::uint64_t i = Below(12); i > 0; --i) text += kPieces[Below(kPieces.size())];
  return text;
}

survey::Pose2 RandomArtefacts::Pose() { return {Real(1e7), Real(1e7), Real(3.2)}; }

std::vector<survey::StampNs> RandomArtefacts::Stamps(int count) {
  std::vector<survey::StampNs> stamps;
  auto stamp = static_cast<survey::StampNs>(1'600'000'000'000'000'000 + Below(1'000'000'000'000));
  for (int i = 0; i < count; ++i) {
    stamp += static_cast<survey::StampNs>(1 + Below(50'000'000));
    stamps.push_back(stamp);
  }
  return stamps;
}

std::vector<survey::ScanStamp> RandomArtefacts::ScanStamps(int count) {
  std::vector<survey::ScanStamp> stamps;
  for (const survey::StampNs stamp : Stamps(count))
    stamps.push_back({stamp, stamp + static_cast<survey::StampNs>(Below(1000))});
  return stamps;
}

formats::Provenance RandomArtefacts::Provenance(int num_ancestors) {
  std::vector<formats::ProvenanceRecord> chain;
  for (int i = 0; i <= num_ancestors; ++i) {
    formats::ProvenanceRecord record{.stage = "stage" + std::to_string(i), .version = "0.1.0"};
    record.options = {{"cell-size-m", std::to_string(Real(1.0))}, {"text", Text()}};
    record.inputs.push_back({.role = "raw " + Text(), .sha256 = formats::Sha256(Text())});
    if (i > 0) record.inputs.push_back({"track", formats::Sha256(Text()), Coin(), chain.back().Id()});
    chain.push_back(std::move(record));
  }
  formats::Provenance provenance{.records = {chain.back()}};
  chain.pop_back();
  std::sort(chain.begin(), chain.end(), [](const auto& a, const auto& b) { return a.Id() < b.Id(); });
  provenance.records.insert(provenance.records.end(), chain.begin(), chain.end());
  return provenance;
}

survey::Session RandomArtefacts::Session(int num_scans, int num_beams) {
  survey::Session session;
  session.setup = {Pose(), Vector2(), 0.03, 0.005};
  for (int i = 0; i < 2; ++i)
    session.geometries.push_back({Real(3.0), Real(0.01), Real(1e-4), 0.1, 30.0, num_beams + i});
  for (const survey::StampNs stamp : Stamps(num_scans)) {
    survey::Scan& scan = session.scans.emplace_back();
    scan.stamp_ns = stamp;
    scan.clock_repair_ns = -static_cast<survey::StampNs>(Below(1000));
    scan.geometry = static_cast<int>(Below(2));
    scan.ranges_m.resize(static_cast<std::size_t>(num_beams + scan.geometry));
    for (float& range : scan.ranges_m) {
      const std::uint64_t kind = Below(10);
      range = kind == 0 ? survey::kNoReturn : kind == 1 ? survey::kInvalidRange : static_cast<float>(Real(30.0));
    }
  }
  const auto vector3 = [&] { return Eigen::Vector3d(Real(10), Real(10), Real(10)); };
  for (const survey::StampNs stamp : Stamps(num_scans)) {
    session.imu.push_back({stamp, vector3(), vector3()});
    session.odometry.push_back({stamp, Pose()});
  }
  for (int i = 0; i < 3; ++i) session.marks.push_back({Text(), 5 * i - 10, 5 * i - 8});
  return session;
}

survey::SubmapConstraint RandomArtefacts::Constraint(int num_submaps, int num_scans) {
  return {{static_cast<int>(Below(static_cast<std::uint64_t>(num_submaps)))},
          ScanIdOf(Below(static_cast<std::uint64_t>(num_scans))),
          Pose(),
          Covariance<3>()};
}

survey::NavigationSummary RandomArtefacts::Navigation() {
  const auto positive = [this] { return std::abs(Real(100.0)); };
  return {positive(), positive(), positive(), positive(), 2, {Real(1), Real(1), Real(1)}, {Real(1), Real(1), Real(1)}};
}

survey::Track RandomArtefacts::Track(int num_scans) {
  const auto scans = static_cast<std::uint64_t>(num_scans);
  survey::Track track;
  for (int i = 0; i < num_scans; ++i) {
    track.scans.push_back({{i},
                           Pose(),
                           Covariance<3>(),
                           static_cast<survey::Prediction>(Below(4)),
                           Coin(),
                           Coin(),
                           static_cast<float>(Real(1.0))});
  }
  for (int i = 0; i < 5; ++i) {
    survey::Submap& submap = track.submaps.emplace_back(survey::Submap{{i}, Pose(), {}});
    for (std::uint64_t n = Below(4); n > 0; --n) submap.nodes.push_back(ScanIdOf(Below(scans)));
    track.constraints.push_back(Constraint(i + 1, num_scans));
    track.marks.push_back({Text(), i, i + 1, ScanIdOf(Below(scans)), Vector2(), Covariance<2>()});
    track.requests.push_back({ScanIdOf(Below(scans)), Text(), Real(1.0), Text(), {{Pose(), 0.25}, {Pose(), 0.75}}});
  }
  track.navigation = Navigation();
  return track;
}

survey::Loops RandomArtefacts::Loops(int num_loops) {
  survey::Loops loops;
  loops.candidates_searched = static_cast<int>(Below(100000));
  for (int i = 0; i < num_loops; ++i) loops.loops.push_back({Constraint(50, 1000), Real(1.0), Coin(), Text()});
  return loops;
}

survey::ControlNetwork RandomArtefacts::Control(int num_points) {
  survey::ControlNetwork network{{"EPSG:25832", Text()}, {}};
  const auto maybe = [&](double value) { return Coin() ? std::optional(value) : std::nullopt; };
  for (int i = 0; i < num_points; ++i) {
    network.points.push_back({std::to_string(i) + Text(), static_cast<survey::PointRole>(Below(4)), Vector2(),
                              Covariance<2>(), maybe(Real(100.0)), maybe(std::abs(Real(0.1))), Text(), Text()});
    if (i > 0) network.correlations.push_back({i - 1, i, Eigen::Matrix2d{{Real(1), Real(1)}, {Real(1), Real(1)}}});
  }
  network.adjustment = {.software = Text(),
                        .description = Text(),
                        .num_observations = num_points,
                        .num_unknowns = 7,
                        .defect = 3,
                        .degrees_of_freedom = 11,
                        .sigma_zero_a_priori = 10.0,
                        .sigma_zero = 9.5,
                        .degrees = Coin(),
                        .scaled = Coin(),
                        .chi_square = 12.5,
                        .chi_square_lower = 3.0,
                        .chi_square_upper = 21.0,
                        .critical_w = 3.29,
                        .largest_w = 2.5,
                        .num_uncontrolled = 1,
                        .num_suspected = 2};
  for (int i = 0; i < num_points; ++i) {
    network.observations.push_back({Text(), Text(), Text(), Text(), Coin(), Real(1e3), 1e-3, Real(1e3), Real(1e-2),
                                    5e-4, Real(4.0), std::abs(Real(1.0)), maybe(0.01), static_cast<int>(Below(3))});
  }
  network.remarks = {Text(), Text()};
  return network;
}

survey::Solution RandomArtefacts::Solution(int num_scans) {
  survey::Solution solution{
      .tied = true, .frame = {"EPSG:25832", Text()}, .site_from_local = Pose(), .rigid_scale = Real(1)};
  for (int i = 0; i < num_scans; ++i) {
    solution.scans.push_back({{i}, Pose(), Coin()});
    if (solution.scans.back().is_node) solution.covariances.push_back({{i}, Covariance<3>()});
  }
  for (int i = 0; i < 5; ++i) {
    solution.submaps.push_back({{i}, Pose()});
    solution.marks.push_back({Text(), i, i + 1, ScanIdOf(Below(static_cast<std::uint64_t>(num_scans))), Coin(),
                              Vector2(), Covariance<2>(), Vector2(), Vector2(), Text(), std::nullopt});
    if (Coin()) {
      solution.marks.back().test = {std::abs(Real(1)), std::abs(Real(9)), 2, std::abs(Real(1)), std::nullopt,
                                    Vector2(),         Covariance<2>()};
    }
  }
  solution.navigation = Navigation();
  solution.breaks = {{ScanIdOf(0), Text()}, {ScanIdOf(1), Text()}};
  solution.control = {Real(1), Real(1), Real(1e-3), Real(1e-3), Real(9), 5, Real(9), Real(9), 13.8, 17.0, Coin()};
  solution.components = {{"scan match", 7, Real(9), Real(1)}, {Text(), 8, Real(9), Real(1)}};
  solution.findings = {Text(), Text()};
  solution.statistics = {1, 2, 3, 4, 5, 6, 7, Real(1e9), Real(1.0), Real(2.0)};
  return solution;
}

survey::ControlledGraph RandomArtefacts::Graph(int num_nodes) {
  survey::ControlledGraph result;
  survey::BlockGraph& block = result.block;
  block.num_submaps = 2;
  for (int i = 0; i < num_nodes; ++i) block.nodes.push_back({3 * i});
  for (int i = 0; i < num_nodes + 2; ++i) block.graph.poses.push_back(Pose());
  block.point_names = {"P1", "P2", "P3"};
  result.control = {"P1", "P3"};
  for (int i = 0; i < 4; ++i) {
    block.graph.points.push_back(Vector2());
    block.graph.marks.push_back({i + 2, i, Vector2(), Covariance<2>()});
  }
  block.graph.given = {{{1}, Vector2(), 0.0625 * Eigen::Matrix2d::Identity()}};  // P2, the block's own
  for (int i = 1; i < num_nodes + 2; ++i) {
    const auto kind = Coin() ? survey::EdgeKind::kMotion : survey::EdgeKind::kLoop;
    block.graph.edges.push_back({i - 1, i, Pose(), Covariance<3>(), false, kind});
  }
  block.graph.walls = {
      {2, 3, {survey::WallRelation::kParallel, {Vector2(), Vector2()}, {Vector2(), Vector2()}}, {0.1, 0.2}}};
  result.site_pose = num_nodes + 2;
  block.graph.poses.emplace_back();
  block.graph.edges.push_back({num_nodes + 2, 4, Pose(), Covariance<3>(), false, survey::EdgeKind::kAnswer});
  return result;
}

std::vector<ArtefactCase> SmallArtefacts(std::uint64_t seed) {
  using std::filesystem::path;
  RandomArtefacts random(seed);
  const formats::Provenance chain = random.Provenance(2);
  const auto stamps = random.ScanStamps(30);
  return {
      {"session", [chain, s = random.Session(30, 50)](const path& f) { formats::WriteSession(f, s, chain); },
       [](const path& f) { formats::ReadSession(f); },
       [](const path& f, const path& to) {
         formats::WriteSession(to, formats::ReadSession(f), formats::ReadProvenance(f));
       }},
      {"track", [chain, stamps, t = random.Track(30)](const path& f) { formats::WriteTrack(f, t, stamps, chain); },
       [](const path& f) { formats::ReadTrack(f); },
       [](const path& f, const path& to) {
         formats::WriteTrack(to, formats::ReadTrack(f), formats::ReadScanStamps(f), formats::ReadProvenance(f));
       }},
      {"loops", [chain, l = random.Loops(20)](const path& f) { formats::WriteLoops(f, l, chain); },
       [](const path& f) { formats::ReadLoops(f); },
       [](const path& f, const path& to) {
         formats::WriteLoops(to, formats::ReadLoops(f), formats::ReadProvenance(f));
       }},
      {"control", [chain, c = random.Control(20)](const path& f) { formats::WriteControl(f, c, chain); },
       [](const path& f) { formats::ReadControl(f); },
       [](const path& f, const path& to) {
         formats::WriteControl(to, formats::ReadControl(f), formats::ReadProvenance(f));
       }},
      {"solution",
       [chain, stamps, s = random.Solution(30)](const path& f) { formats::WriteSolution(f, s, stamps, chain); },
       [](const path& f) { formats::ReadSolution(f); },
       [](const path& f, const path& to) {
         formats::WriteSolution(to, formats::ReadSolution(f), formats::ReadScanStamps(f), formats::ReadProvenance(f));
       }},
      {"graph", [chain, g = random.Graph(20)](const path& f) { formats::WriteGraph(f, g, chain); },
       [](const path& f) { formats::ReadGraph(f); },
       [](const path& f, const path& to) {
         formats::WriteGraph(to, formats::ReadGraph(f), formats::ReadProvenance(f));
       }},
  };
}

}  // namespace test_support
