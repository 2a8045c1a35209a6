// SPDX-License-Identifier: Apache-2.0
//
// What is written is read back bit by bit, the same content gives the same bytes, and what cannot be read says why.
#include "formats/artefacts.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/artefact_file.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/random_artefacts.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using test_support::RandomArtefacts;
using test_support::ScratchFolder;

bool Same(const survey::Pose2& a, const survey::Pose2& b) { return a.Vector() == b.Vector(); }

bool SameBits(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
  });
}

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const DataError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Artefacts, SessionSurvives) {
  const ScratchFolder folder;
  RandomArtefacts random(1);
  const survey::Session written = random.Session(200, 361);
  WriteSession(folder / "session.sqlite", written, random.Provenance(0));
  const survey::Session read = ReadSession(folder / "session.sqlite");

  EXPECT_TRUE(Same(read.setup.body_from_lidar, written.setup.body_from_lidar));
  EXPECT_EQ(read.setup.mark_in_lidar, written.setup.mark_in_lidar);
  EXPECT_EQ(read.setup.range_sigma_m, written.setup.range_sigma_m);
  EXPECT_EQ(read.setup.mark_sigma_m, written.setup.mark_sigma_m);
  EXPECT_EQ(read.geometries, written.geometries);
  ASSERT_EQ(read.scans.size(), written.scans.size());
  std::vector<float> buffer;
  for (std::size_t i = 0; i < read.scans.size(); ++i) {
    EXPECT_EQ(read.scans[i].stamp_ns, written.scans[i].stamp_ns);
    EXPECT_EQ(read.scans[i].clock_repair_ns, written.scans[i].clock_repair_ns);
    EXPECT_EQ(read.scans[i].geometry, written.scans[i].geometry);
    EXPECT_TRUE(SameBits(survey::RangesOf(read, i, &buffer), written.scans[i].ranges_m));
    EXPECT_EQ(read.scans[i].ranges_m.capacity(), 0U);  // nothing of a long drive stays in memory
  }
  ASSERT_EQ(read.imu.size(), written.imu.size());
  ASSERT_EQ(read.odometry.size(), written.odometry.size());
  for (std::size_t i = 0; i < read.imu.size(); ++i) {
    EXPECT_EQ(read.imu[i].stamp_ns, written.imu[i].stamp_ns);
    EXPECT_EQ(read.imu[i].angular_rate_in_body, written.imu[i].angular_rate_in_body);
    EXPECT_EQ(read.imu[i].specific_force_in_body, written.imu[i].specific_force_in_body);
    EXPECT_EQ(read.odometry[i].stamp_ns, written.odometry[i].stamp_ns);
    EXPECT_TRUE(Same(read.odometry[i].odom_from_body, written.odometry[i].odom_from_body));
  }
  ASSERT_EQ(read.marks.size(), written.marks.size());
  for (std::size_t i = 0; i < read.marks.size(); ++i) {
    EXPECT_EQ(read.marks[i].point, written.marks[i].point);
    EXPECT_EQ(read.marks[i].start_ns, written.marks[i].start_ns);
    EXPECT_EQ(read.marks[i].end_ns, written.marks[i].end_ns);
  }
}

void ExpectSame(const survey::SubmapConstraint& a, const survey::SubmapConstraint& b) {
  EXPECT_EQ(a.submap, b.submap);
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_TRUE(Same(a.submap_from_scan, b.submap_from_scan));
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Artefacts, TrackSurvives) {
  const ScratchFolder folder;
  RandomArtefacts random(2);
  const survey::Track written = random.Track(300);
  const auto stamps = random.ScanStamps(300);
  WriteTrack(folder / "track.sqlite", written, stamps, random.Provenance(1));
  std::vector<survey::ScanStamp> read_stamps;
  const survey::Track read = ReadTrack(folder / "track.sqlite", &read_stamps);

  EXPECT_EQ(read_stamps, stamps);
  EXPECT_EQ(ReadScanStamps(folder / "track.sqlite"), stamps);
  ASSERT_EQ(read.scans.size(), written.scans.size());
  for (std::size_t i = 0; i < read.scans.size(); ++i) {
    const survey::TrackedScan& a = read.scans[i];
    const survey::TrackedScan& b = written.scans[i];
    EXPECT_EQ(a.scan, b.scan);
    EXPECT_TRUE(Same(a.local_from_scan, b.local_from_scan));
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.prediction, b.prediction);
    EXPECT_EQ(a.matched, b.matched);
    EXPECT_EQ(a.is_node, b.is_node);
    EXPECT_EQ(a.score, b.score);
  }
  ASSERT_EQ(read.submaps.size(), written.submaps.size());
  ASSERT_EQ(read.constraints.size(), written.constraints.size());
  ASSERT_EQ(read.marks.size(), written.marks.size());
  ASSERT_EQ(read.requests.size(), written.requests.size());
  for (std::size_t i = 0; i < read.submaps.size(); ++i) {
    EXPECT_EQ(read.submaps[i].id, written.submaps[i].id);
    EXPECT_TRUE(Same(read.submaps[i].local_from_submap, written.submaps[i].local_from_submap));
    EXPECT_EQ(read.submaps[i].nodes, written.submaps[i].nodes);
    ExpectSame(read.constraints[i], written.constraints[i]);
    EXPECT_EQ(read.marks[i].point, written.marks[i].point);
    EXPECT_EQ(read.marks[i].start_ns, written.marks[i].start_ns);
    EXPECT_EQ(read.marks[i].end_ns, written.marks[i].end_ns);
    EXPECT_EQ(read.marks[i].scan, written.marks[i].scan);
    EXPECT_EQ(read.marks[i].mark_in_scan, written.marks[i].mark_in_scan);
    EXPECT_EQ(read.marks[i].covariance, written.marks[i].covariance);
    EXPECT_EQ(read.requests[i].scan, written.requests[i].scan);
    EXPECT_EQ(read.requests[i].cause, written.requests[i].cause);
    EXPECT_EQ(read.requests[i].doubt, written.requests[i].doubt);
    EXPECT_EQ(read.requests[i].message, written.requests[i].message);
  }
}

TEST(Artefacts, LoopsSurvive) {
  const ScratchFolder folder;
  RandomArtefacts random(3);
  const survey::Loops written = random.Loops(40);
  WriteLoops(folder / "loops.sqlite", written, random.Provenance(1));
  const survey::Loops read = ReadLoops(folder / "loops.sqlite");

  EXPECT_EQ(read.candidates_searched, written.candidates_searched);
  ASSERT_EQ(read.loops.size(), written.loops.size());
  for (std::size_t i = 0; i < read.loops.size(); ++i) {
    ExpectSame(read.loops[i].constraint, written.loops[i].constraint);
    EXPECT_EQ(read.loops[i].score, written.loops[i].score);
    EXPECT_EQ(read.loops[i].accepted, written.loops[i].accepted);
    EXPECT_EQ(read.loops[i].reason, written.loops[i].reason);
  }
}

TEST(Artefacts, ControlSurvives) {
  const ScratchFolder folder;
  RandomArtefacts random(4);
  const survey::ControlNetwork written = random.Control(40);
  WriteControl(folder / "control.sqlite", written, random.Provenance(0));
  const survey::ControlNetwork read = ReadControl(folder / "control.sqlite");

  EXPECT_EQ(read.frame.crs, written.frame.crs);
  EXPECT_EQ(read.frame.wkt2, written.frame.wkt2);
  ASSERT_EQ(read.points.size(), written.points.size());
  for (std::size_t i = 0; i < read.points.size(); ++i) {
    EXPECT_EQ(read.points[i].name, written.points[i].name);
    EXPECT_EQ(read.points[i].role, written.points[i].role);
    EXPECT_EQ(read.points[i].position_in_site, written.points[i].position_in_site);
    EXPECT_EQ(read.points[i].covariance, written.points[i].covariance);
    EXPECT_EQ(read.points[i].elevation_m, written.points[i].elevation_m);
    EXPECT_EQ(read.points[i].elevation_sigma_m, written.points[i].elevation_sigma_m);
    EXPECT_EQ(read.points[i].description, written.points[i].description);
    EXPECT_EQ(read.points[i].reason, written.points[i].reason);
  }
  ASSERT_EQ(read.correlations.size(), written.correlations.size());
  for (std::size_t i = 0; i < read.correlations.size(); ++i) {
    EXPECT_EQ(read.correlations[i].a, written.correlations[i].a);
    EXPECT_EQ(read.correlations[i].b, written.correlations[i].b);
    EXPECT_EQ(read.correlations[i].covariance, written.correlations[i].covariance);
  }
  ASSERT_TRUE(read.adjustment.has_value());
  EXPECT_EQ(read.adjustment->software, written.adjustment->software);
  EXPECT_EQ(read.adjustment->sigma_zero, written.adjustment->sigma_zero);
  EXPECT_EQ(read.adjustment->scaled, written.adjustment->scaled);
  EXPECT_EQ(read.adjustment->chi_square_upper, written.adjustment->chi_square_upper);
  EXPECT_EQ(read.adjustment->num_suspected, written.adjustment->num_suspected);
  ASSERT_EQ(read.observations.size(), written.observations.size());
  for (std::size_t i = 0; i < read.observations.size(); ++i) {
    EXPECT_EQ(read.observations[i].kind, written.observations[i].kind);
    EXPECT_EQ(read.observations[i].fore, written.observations[i].fore);
    EXPECT_EQ(read.observations[i].residual, written.observations[i].residual);
    EXPECT_EQ(read.observations[i].minimal_detectable_bias, written.observations[i].minimal_detectable_bias);
    EXPECT_EQ(read.observations[i].suspected, written.observations[i].suspected);
  }
  EXPECT_EQ(read.remarks, written.remarks);
}

TEST(Artefacts, SolutionSurvives) {
  const ScratchFolder folder;
  RandomArtefacts random(5);
  survey::Solution written = random.Solution(100);
  written.statistics.sigma_zero = std::nan("");
  const auto stamps = random.ScanStamps(100);
  WriteSolution(folder / "solution.sqlite", written, stamps, random.Provenance(3));
  const survey::Solution read = ReadSolution(folder / "solution.sqlite");

  EXPECT_EQ(ReadScanStamps(folder / "solution.sqlite"), stamps);
  EXPECT_EQ(read.tied, written.tied);
  EXPECT_EQ(read.frame.crs, written.frame.crs);
  EXPECT_EQ(read.frame.wkt2, written.frame.wkt2);
  EXPECT_TRUE(Same(read.site_from_local, written.site_from_local));
  EXPECT_EQ(read.rigid_scale, written.rigid_scale);
  ASSERT_EQ(read.scans.size(), written.scans.size());
  for (std::size_t i = 0; i < read.scans.size(); ++i) {
    EXPECT_EQ(read.scans[i].scan, written.scans[i].scan);
    EXPECT_TRUE(Same(read.scans[i].site_from_scan, written.scans[i].site_from_scan));
    EXPECT_EQ(read.scans[i].is_node, written.scans[i].is_node);
  }
  ASSERT_EQ(read.covariances.size(), written.covariances.size());
  for (std::size_t i = 0; i < read.covariances.size(); ++i) {
    EXPECT_EQ(read.covariances[i].scan, written.covariances[i].scan);
    EXPECT_EQ(read.covariances[i].covariance, written.covariances[i].covariance);
  }
  ASSERT_EQ(read.submaps.size(), written.submaps.size());
  ASSERT_EQ(read.marks.size(), written.marks.size());
  for (std::size_t i = 0; i < read.marks.size(); ++i) {
    EXPECT_EQ(read.submaps[i].id, written.submaps[i].id);
    EXPECT_TRUE(Same(read.submaps[i].site_from_submap, written.submaps[i].site_from_submap));
    EXPECT_EQ(read.marks[i].point, written.marks[i].point);
    EXPECT_EQ(read.marks[i].start_ns, written.marks[i].start_ns);
    EXPECT_EQ(read.marks[i].end_ns, written.marks[i].end_ns);
    EXPECT_EQ(read.marks[i].scan, written.marks[i].scan);
    EXPECT_EQ(read.marks[i].used, written.marks[i].used);
    EXPECT_EQ(read.marks[i].position_in_site, written.marks[i].position_in_site);
    EXPECT_EQ(read.marks[i].covariance, written.marks[i].covariance);
    EXPECT_EQ(read.marks[i].residual, written.marks[i].residual);
    EXPECT_EQ(read.marks[i].rigid_residual, written.marks[i].rigid_residual);
  }
  EXPECT_EQ(read.statistics.iterations, 7);
  EXPECT_EQ(read.statistics.initial_cost, written.statistics.initial_cost);
  EXPECT_EQ(read.statistics.final_cost, written.statistics.final_cost);
  EXPECT_TRUE(std::isnan(read.statistics.sigma_zero));
}

TEST(Artefacts, GraphSurvives) {
  const ScratchFolder folder;
  RandomArtefacts random(9);
  const survey::ControlledGraph written = random.Graph(12);
  WriteGraph(folder / "graph.sqlite", written, random.Provenance(1));
  const survey::ControlledGraph read = ReadGraph(folder / "graph.sqlite");
  EXPECT_EQ(read.control, written.control);
  EXPECT_EQ(read.block.nodes, written.block.nodes);
  EXPECT_EQ(read.block.num_submaps, written.block.num_submaps);
  EXPECT_EQ(read.block.point_names, written.block.point_names);
  const survey::PoseGraph &graph = read.block.graph, &expected = written.block.graph;
  EXPECT_EQ(graph.points, expected.points);
  ASSERT_EQ(graph.poses.size(), expected.poses.size());
  for (std::size_t i = 0; i < graph.poses.size(); ++i) EXPECT_TRUE(Same(graph.poses[i], expected.poses[i]));
  ASSERT_EQ(graph.marks.size(), expected.marks.size());
  EXPECT_EQ(graph.marks[3].pose, expected.marks[3].pose);
  EXPECT_EQ(graph.marks[3].p_in_pose, expected.marks[3].p_in_pose);
  EXPECT_EQ(graph.marks[3].covariance, expected.marks[3].covariance);
  ASSERT_EQ(graph.edges.size(), expected.edges.size());
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    EXPECT_EQ(graph.edges[i].kind, expected.edges[i].kind);
    EXPECT_EQ(graph.edges[i].target, expected.edges[i].target);
    EXPECT_TRUE(Same(graph.edges[i].base_from_target, expected.edges[i].base_from_target));
    EXPECT_EQ(graph.edges[i].covariance, expected.edges[i].covariance);
  }
  EXPECT_EQ(read.site_pose, 14);
  ASSERT_EQ(graph.walls.size(), 1U);
  EXPECT_EQ(graph.walls[0].walls.relation, survey::WallRelation::kParallel);
  EXPECT_EQ(graph.walls[0].walls.in_target.b, expected.walls[0].walls.in_target.b);
  EXPECT_EQ(graph.walls[0].sigma, expected.walls[0].sigma);
}

TEST(Artefacts, EmptyListsSurvive) {
  const ScratchFolder folder;
  RandomArtefacts random(6);
  WriteTrack(folder / "track.sqlite", {}, {}, random.Provenance(0));
  EXPECT_TRUE(ReadTrack(folder / "track.sqlite").scans.empty());
  WriteLoops(folder / "loops.sqlite", {}, random.Provenance(0));
  EXPECT_TRUE(ReadLoops(folder / "loops.sqlite").loops.empty());
}

TEST(Artefacts, ProvenanceSurvives) {
  const ScratchFolder folder;
  for (const auto& artefact : test_support::SmallArtefacts(7)) {
    const auto file = folder / (artefact.name + ".sqlite");
    artefact.write(file);
    const Provenance expected = RandomArtefacts(7).Provenance(2);
    EXPECT_EQ(ToJson(ReadProvenance(file)), ToJson(expected)) << artefact.name;
  }
}

TEST(Artefacts, SameContentGivesSameBytesAndKeepsTheFile) {
  const ScratchFolder folder;
  for (const auto& artefact : test_support::SmallArtefacts(8)) {
    artefact.write(folder / "one.sqlite");
    const auto time = std::filesystem::last_write_time(folder / "one.sqlite");
    artefact.write(folder / "one.sqlite");
    EXPECT_EQ(std::filesystem::last_write_time(folder / "one.sqlite"), time) << artefact.name;
    artefact.copy(folder / "one.sqlite", folder / "two.sqlite");
    EXPECT_EQ(ReadWholeFile(folder / "one.sqlite"), ReadWholeFile(folder / "two.sqlite")) << artefact.name;
  }
}

TEST(Artefacts, WholeFilesPassTheExamination) {
  const ScratchFolder folder;
  for (const auto& artefact : test_support::SmallArtefacts(9)) {
    const auto file = folder / (artefact.name + ".sqlite");
    artefact.write(file);
    EXPECT_TRUE(ExamineArtefact(file).empty()) << artefact.name;
  }
}

TEST(Artefacts, MessagesNameTheFileAndTheRule) {
  const ScratchFolder folder;
  RandomArtefacts random(10);
  const auto file = folder / "a?b#c%d.sqlite";
  EXPECT_EQ(MessageOf([&] { ReadLoops(file); }), file.string() + ": no such file");
  EXPECT_EQ(MessageOf([&] { ReadLoops(folder.path()); }), folder.path().string() + ": is a folder");
  WriteLoops(file, random.Loops(3), random.Provenance(0));
  EXPECT_EQ(ReadLoops(file).loops.size(), 3U);
  EXPECT_EQ(MessageOf([&] { ReadTrack(file); }), file.string() + ": a loops file, expected a track file");
  EXPECT_EQ(MessageOf([&] { ReadScanStamps(file); }), file.string() + ": a loops file, expected a track or solution");
  WriteFileAtomically(file, "t,x,y,theta\n");
  EXPECT_EQ(MessageOf([&] { ReadTrack(file); }), file.string() + ": not an SQLite file");
  WriteFileAtomically(file, "");
  EXPECT_EQ(MessageOf([&] { ReadTrack(file); }), file.string() + ": an SQLite file, but not one of Plumbline's");
}

TEST(Artefacts, AnotherFormatVersionIsRefused) {
  const ScratchFolder folder;
  const auto file = folder / "loops.sqlite";
  WriteLoops(file, {}, RandomArtefacts(11).Provenance(0));
  std::string bytes = ReadWholeFile(file);
  constexpr std::size_t kUserVersionLowByte = 63;
  ++bytes[kUserVersionLowByte];
  WriteFileAtomically(file, bytes);
  EXPECT_EQ(MessageOf([&] { ReadLoops(file); }),
            file.string() + ": loops file of format version 2; this program reads version 1");
}

TEST(Artefacts, WritersRefuseBrokenContent) {
  const ScratchFolder folder;
  RandomArtefacts random(12);
  survey::Track track = random.Track(10);
  EXPECT_THROW(WriteTrack(folder / "t.sqlite", track, random.ScanStamps(9), random.Provenance(0)), std::logic_error);
  track.constraints[0].submap = {77};
  EXPECT_THROW(WriteTrack(folder / "t.sqlite", track, random.ScanStamps(10), random.Provenance(0)), std::logic_error);
  survey::Loops loops = random.Loops(3);
  loops.loops[1].constraint.submap_from_scan.theta = std::nan("");
  EXPECT_THROW(WriteLoops(folder / "t.sqlite", loops, random.Provenance(0)), std::logic_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Artefacts, TheLastNanosecondAndTheLargestNumbersSurvive) {
  const ScratchFolder folder;
  survey::Session session = RandomArtefacts(13).Session(1, 3);
  session.scans[0].stamp_ns = std::numeric_limits<std::int64_t>::max();
  session.odometry = {{std::numeric_limits<std::int64_t>::min(), {5e-324, 1.7976931348623157e308, -0.1}}};
  WriteSession(folder / "s.sqlite", session, RandomArtefacts(13).Provenance(0));
  const survey::Session read = ReadSession(folder / "s.sqlite");
  EXPECT_EQ(read.scans[0].stamp_ns, session.scans[0].stamp_ns);
  EXPECT_EQ(read.odometry[0].stamp_ns, session.odometry[0].stamp_ns);
  EXPECT_TRUE(Same(read.odometry[0].odom_from_body, session.odometry[0].odom_from_body));
}

}  // namespace
}  // namespace formats
