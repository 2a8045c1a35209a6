// SPDX-License-Identifier: Apache-2.0
#include "survey/accuracy/contradiction.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "survey/grid/line_cells.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"

namespace survey {
namespace {

enum class Seen : std::uint8_t { kTooLittle, kThrough, kWallNear };

// What one pass saw, cells of the common raster from (min_column, min_row) on.
struct Pass {
  int min_column = 0;
  int min_row = 0;
  int width = 0;
  int height = 0;
  std::vector<Seen> seen;                  // by cell
  std::vector<std::pair<int, int>> walls;  // column, row of the cells hit often enough
  double begin_m = 0.0;                    // on the path
  double end_m = 0.0;
  std::vector<std::size_t> scans;

  // Index of a cell, or -1.
  std::ptrdiff_t At(int column, int row) const {
    const int c = column - min_column;
    const int r = row - min_row;
    if (c < 0 || r < 0 || c >= width || r >= height) return -1;
    return static_cast<std::ptrdiff_t>(r) * width + c;
  }
};

// Counts by cell of a pass.
struct Counts {
  explicit Counts(std::size_t cells) : hits(cells, 0), rays(cells, 0) {}

  static void Add(std::vector<std::uint8_t>* counts, std::ptrdiff_t cell) {
    if (cell < 0) return;
    std::uint8_t& count = (*counts)[static_cast<std::size_t>(cell)];
    if (count < 255) ++count;
  }

  std::vector<std::uint8_t> hits;
  std::vector<std::uint8_t> rays;  // that went through
};

std::vector<Pass> CutPath(const std::vector<Pose2>& poses, const ContradictionOptions& options) {
  std::vector<Pass> passes;
  double way = 0.0;
  double drawn = -options.drawn_every_m;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) way += (poses[i].Translation() - poses[i - 1].Translation()).norm();
    if (passes.empty() || way >= passes.back().begin_m + options.piece_m) passes.emplace_back().begin_m = way;
    passes.back().end_m = way;
    if (way < drawn + options.drawn_every_m) continue;
    drawn = way;
    passes.back().scans.push_back(i);
  }
  return passes;
}

void Bound(const std::vector<Pose2>& poses, const ContradictionOptions& options, Pass* pass) {
  Eigen::Vector2d low = poses[pass->scans.front()].Translation();
  Eigen::Vector2d high = low;
  for (const std::size_t scan : pass->scans) {
    low = low.cwiseMin(poses[scan].Translation());
    high = high.cwiseMax(poses[scan].Translation());
  }
  const auto cell = [&](double p) { return static_cast<int>(std::floor(p / options.cell_size_m)); };
  pass->min_column = cell(low.x() - options.max_range_m) - 1;
  pass->min_row = cell(low.y() - options.max_range_m) - 1;
  pass->width = cell(high.x() + options.max_range_m) + 2 - pass->min_column;
  pass->height = cell(high.y() + options.max_range_m) + 2 - pass->min_row;
  pass->seen.assign(static_cast<std::size_t>(pass->width) * static_cast<std::size_t>(pass->height), Seen::kTooLittle);
}

void MarkNear(int row, int column, int reach, Pass* pass) {
  for (int r = std::max(row - reach, 0); r <= std::min(row + reach, pass->height - 1); ++r) {
    const auto begin = pass->seen.begin() + static_cast<std::ptrdiff_t>(r) * pass->width;
    std::fill(begin + std::max(column - reach, 0), begin + std::min(column + reach + 1, pass->width), Seen::kWallNear);
  }
}

void FindWalls(const Counts& counts, const ContradictionOptions& options, Pass* pass) {
  for (std::size_t cell = 0; cell < counts.rays.size(); ++cell) {
    if (counts.rays[cell] >= options.min_rays) pass->seen[cell] = Seen::kThrough;
  }
  const int reach = static_cast<int>(std::ceil(options.wall_near_m / options.cell_size_m));
  std::size_t cell = 0;
  for (int row = 0; row < pass->height; ++row) {
    for (int column = 0; column < pass->width; ++column, ++cell) {
      if (counts.hits[cell] == 0) continue;
      MarkNear(row, column, reach, pass);
      if (counts.hits[cell] >= options.min_hits)
        pass->walls.emplace_back(column + pass->min_column, row + pass->min_row);
    }
  }
}

// Keeps only the rectangle in which something was seen: rooms are smaller than the reach of the lidar.
void Trim(Pass* pass) {
  int first_column = pass->width, end_column = 0, first_row = pass->height, end_row = 0;
  std::size_t cell = 0;
  for (int row = 0; row < pass->height; ++row) {
    for (int column = 0; column < pass->width; ++column, ++cell) {
      if (pass->seen[cell] == Seen::kTooLittle) continue;
      first_column = std::min(first_column, column);
      end_column = std::max(end_column, column + 1);
      first_row = std::min(first_row, row);
      end_row = row + 1;
    }
  }
  const int width = std::max(end_column - first_column, 0);
  const int height = std::max(end_row - first_row, 0);
  std::vector<Seen> kept;
  kept.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = first_row; row < end_row; ++row) {
    const auto begin = pass->seen.begin() + static_cast<std::ptrdiff_t>(row) * pass->width + first_column;
    kept.insert(kept.end(), begin, begin + width);
  }
  pass->seen = std::move(kept);
  pass->min_column += first_column;
  pass->min_row += first_row;
  pass->width = width;
  pass->height = height;
}

void Draw(const Session& session, const std::vector<Pose2>& poses, const ScanProjector& projector,
          const ContradictionOptions& options, Pass* pass) {
  Bound(poses, options, pass);
  Counts counts(pass->seen.size());
  // Near the origin of the pass single precision is exact enough, also for site coordinates.
  const Eigen::Vector2d origin(pass->min_column * options.cell_size_m, pass->min_row * options.cell_size_m);
  const auto cells_per_m = static_cast<float>(1.0 / options.cell_size_m);
  ScanPoints points;
  std::vector<Eigen::Vector2f> hits;
  for (const std::size_t scan : pass->scans) {
    projector.Project(session, scan,
                      TwistOfScan(
                          session.scans, [&](std::size_t i) { return poses[i]; }, scan),
                      &points);
    const Pose2 pose{poses[scan].x - origin.x(), poses[scan].y - origin.y(), poses[scan].theta};
    TransformPoints(pose, points.hits, &hits);
    const Eigen::Vector2f begin = pose.Translation().cast<float>() * cells_per_m;
    for (const Eigen::Vector2f& hit : hits) {
      const Eigen::Vector2f end = hit * cells_per_m;
      const auto cell = [&](int column, int row) { return pass->At(column + pass->min_column, row + pass->min_row); };
      ForEachCellOnLine(begin, end, [&](int column, int row) { Counts::Add(&counts.rays, cell(column, row)); });
      Counts::Add(&counts.hits, cell(static_cast<int>(std::floor(end.x())), static_cast<int>(std::floor(end.y()))));
    }
  }
  FindWalls(counts, options, pass);
  Trim(pass);
}

// The wall cells of `pass` against what `other` saw there.
Contradiction Compare(const Pass& pass, const Pass& other) {
  Contradiction sum;
  for (const auto& [column, row] : pass.walls) {
    const std::ptrdiff_t at = other.At(column, row);
    if (at < 0) continue;
    const Seen seen = other.seen[static_cast<std::size_t>(at)];
    if (seen == Seen::kTooLittle) continue;
    ++sum.compared;
    if (seen == Seen::kThrough) ++sum.contradicted;
  }
  return sum;
}

ScanId IdOf(std::size_t scan) { return {static_cast<int>(scan)}; }

struct Comparison {
  Contradiction sum;
  std::optional<PassConflict> worst;
};

// A pass against all earlier ones that are far enough on the path, both ways.
Comparison CompareWithEarlier(const std::vector<Pass>& passes, std::size_t later, const ContradictionOptions& options) {
  Comparison comparison;
  const Pass& pass = passes[later];
  for (std::size_t i = 0; i < later && pass.begin_m - passes[i].end_m > options.apart_m; ++i) {
    const Pass& other = passes[i];
    Contradiction walls = Compare(pass, other);
    walls += Compare(other, pass);
    comparison.sum += walls;
    const bool conflict = walls.contradicted >= options.conflict_cells && walls.Share() >= options.conflict_share;
    if (!conflict || (comparison.worst && walls.contradicted <= comparison.worst->walls.contradicted)) continue;
    comparison.worst = {IdOf(pass.scans.front()), IdOf(pass.scans.back()), IdOf(other.scans.front()),
                        IdOf(other.scans.back()), walls};
  }
  return comparison;
}

}  // namespace

PassComparison ComparePasses(const Session& session, const std::vector<Pose2>& poses,
                             const ContradictionOptions& options) {
  std::vector<Pass> passes = CutPath(poses, options);
  std::erase_if(passes, [](const Pass& pass) { return pass.scans.empty(); });
  const ScanProjector projector(session.geometries, options.max_range_m, 0.0);
  tbb::parallel_for(std::size_t{0}, passes.size(),
                    [&](std::size_t i) { Draw(session, poses, projector, options, &passes[i]); });
  std::vector<Comparison> comparisons(passes.size());
  tbb::parallel_for(std::size_t{0}, passes.size(),
                    [&](std::size_t i) { comparisons[i] = CompareWithEarlier(passes, i, options); });
  PassComparison result;
  for (const Comparison& comparison : comparisons) {
    result.total += comparison.sum;
    if (comparison.worst) result.conflicts.push_back(*comparison.worst);
  }
  return result;
}

}  // namespace survey
