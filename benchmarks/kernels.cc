// SPDX-License-Identifier: Apache-2.0
//
// Runs one hot kernel a number of times, so that an instruction counter can tell what one run costs: the difference
// of two counts, for N and 2 N runs, divided by N. Without arguments it lists the kernels.
//   plumbline-kernels KERNEL N
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "formats/field_csv.h"
#include "survey/grid/occupancy_pyramid.h"
#include "survey/matching/branch_and_bound.h"
#include "survey/matching/gauss_newton.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"
#include "tests/support/room.h"

namespace {

using Points = std::vector<Eigen::Vector2f>;

// A hall of 36 m x 24 m, three times the furnished room of the tests: near and far walls, pillars, an alcove.
std::vector<test_support::Wall> Hall() {
  std::vector<test_support::Wall> walls = test_support::FurnishedRoom();
  for (test_support::Wall& wall : walls) wall = {3.0 * wall.a, 3.0 * wall.b};
  return walls;
}

constexpr double kRangeSigma_m = 0.03;
constexpr int kNumScans = 40;
constexpr survey::Pose2 kStart{9.0, 7.0, 0.3};

// Scans 0.1 m apart.
survey::Pose2 PoseOfScan(int i) { return {kStart.x + 0.1 * i, kStart.y + 0.02 * i, kStart.theta + 0.01 * i}; }

struct Scans {
  explicit Scans(int num_beams) : geometry(test_support::WideScanner(num_beams)) {
    const survey::ScanProjector projector(std::vector{geometry}, geometry.range_max_m, 0.0);
    const std::vector<test_support::Wall> walls = Hall();
    for (int i = 0; i < kNumScans; ++i) {
      scans.push_back({.stamp_ns = i * std::int64_t{25'000'000},
                       .ranges_m = test_support::SimulateRanges(walls, PoseOfScan(i), geometry, kRangeSigma_m,
                                                                static_cast<std::uint32_t>(i))});
      projector.Project(scans.back().geometry, scans.back().ranges_m, {}, &points.emplace_back());
    }
  }

  const Points& HitsOf(int run) const { return points[static_cast<std::size_t>(run % kNumScans)].hits; }

  survey::ScanGeometry geometry;
  std::vector<survey::Scan> scans;
  std::vector<survey::ScanPoints> points;
};

void Insert(const Scans& scans, int run, survey::OccupancyPyramid* grid) {
  const survey::Pose2 pose = PoseOfScan(run % kNumScans);
  Points hits;
  survey::TransformPoints(pose, scans.HitsOf(run), &hits);
  grid->Insert(pose.Translation().cast<float>(), hits, {});
}

survey::OccupancyPyramid MapOf(const Scans& scans, int num_levels) {
  survey::OccupancyPyramid map({.num_levels = num_levels});
  for (int i = 0; i < kNumScans; ++i) Insert(scans, i, &map);
  return map;
}

void RunInsert(int num_beams, int num_levels, int runs) {
  const Scans scans(num_beams);
  survey::OccupancyPyramid map = MapOf(scans, num_levels);
  for (int run = 0; run < runs; ++run) Insert(scans, run, &map);
}

void RunMatch(int runs) {
  const Scans scans(1081);
  const survey::OccupancyPyramid map = MapOf(scans, 4);
  Points points;
  for (int run = 0; run < runs; ++run) {
    survey::ThinAlongScan(scans.HitsOf(run), 0.05, 180, &points);
    survey::Pose2 start = PoseOfScan(run % kNumScans);
    start.x += 0.03;
    start.theta -= 0.004;
    const survey::MatchResult result =
        MatchScan(map, points, start, start, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal(), {});
    if (!result.usable) std::abort();
  }
}

void RunBranchAndBound(int runs) {
  const Scans scans(361);
  const survey::OccupancyPyramid map = MapOf(scans, 4);
  const survey::SlidingMaximumGrids grids(map, 0, 6, 1.5);
  for (int run = 0; run < runs; ++run) {
    survey::Pose2 centre = PoseOfScan(run % kNumScans);
    centre.x += 0.8;
    centre.y -= 0.5;
    centre.theta += 0.1;
    if (!BranchAndBound(grids, scans.HitsOf(run), centre, {.half_width_m = 1.5, .half_angle_rad = 0.3})) std::abort();
  }
}

void RunCsv(int runs) {
  Scans scans(1081);
  for (survey::Scan& scan : scans.scans) {
    for (float& range : scan.ranges_m) range = std::round(range * 1000.0F) / 1000.0F;  // as scanners tell it
  }
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("plumbline-kernels-" + std::to_string(getpid()) + ".csv");
  formats::WriteScansCsv(file, scans.geometry, scans.scans);
  for (int run = 0; run < runs; ++run) {
    if (formats::ReadScansCsv(file).scans.size() != scans.scans.size()) std::abort();
  }
  std::filesystem::remove(file);
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, void (*)(int)> kernels = {
      {"insert-1081-beams", [](int runs) { RunInsert(1081, 1, runs); }},
      {"insert-180-beams-4-levels", [](int runs) { RunInsert(180, 4, runs); }},
      {"match-180-points", RunMatch},
      {"branch-and-bound-361-points", RunBranchAndBound},
      {"csv-40-rows-1081-ranges", RunCsv},
  };
  if (argc == 1) {
    for (const auto& [name, kernel] : kernels) std::printf("%s\n", name.c_str());
    return 0;
  }
  const auto kernel = argc == 3 ? kernels.find(argv[1]) : kernels.end();
  const int runs = argc == 3 ? std::atoi(argv[2]) : 0;
  if (kernel == kernels.end() || runs < 1) {
    std::fprintf(stderr, "usage: plumbline-kernels KERNEL N\n");
    return 2;
  }
  kernel->second(runs);
  return 0;
}
