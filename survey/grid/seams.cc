// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/seams.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdlib>

#include "survey/geometry/principal_axes.h"
#include "survey/grid/coverage.h"
#include "survey/grid/faces.h"

namespace survey {
namespace {

// Cells [first, end) in site columns or rows.
struct Range {
  std::int64_t first = 0;
  std::int64_t end = 0;
};

Range Common(std::int64_t a, int a_size, std::int64_t b, int b_size) {
  return {std::max(a, b), std::min(a + a_size, b + b_size)};
}

struct Overlap {
  Range columns;
  Range rows;
  bool Empty() const { return columns.first >= columns.end || rows.first >= rows.end; }
};

// Value at a site cell; NaN outside.
float ValueAt(const SiteRaster& raster, std::int64_t site_column, std::int64_t site_row) {
  const std::int64_t column = site_column - raster.min_column;
  const std::int64_t row = site_row - raster.min_row;
  if (!raster.Contains(column, row)) return kUnknownLogOdds;
  return raster.At(static_cast<int>(column), static_cast<int>(row));
}

float LogOddsOf(double probability) { return static_cast<float>(std::log(probability / (1.0 - probability))); }

struct Thresholds {
  float occupied;
  float free;
};

bool HasWallNear(const SiteRaster& raster, std::int64_t column, std::int64_t row, int reach, float occupied) {
  for (std::int64_t r = row - reach; r <= row + reach; ++r) {
    for (std::int64_t c = column - reach; c <= column + reach; ++c) {
      if (ValueAt(raster, c, r) >= occupied) return true;
    }
  }
  return false;
}

void CountCells(const SiteRaster& first, const SiteRaster& second, const Overlap& overlap, const SeamOptions& options,
                Seam* seam) {
  const Thresholds limit{LogOddsOf(options.occupied_probability), LogOddsOf(options.free_probability)};
  const int reach = static_cast<int>(std::lround(options.wall_tolerance_m / first.cell_size_m));
  std::int64_t known = 0;
  std::int64_t disagreeing = 0;
  std::int64_t walls[2] = {0, 0};
  std::int64_t contradicted[2] = {0, 0};
  const SiteRaster* maps[2] = {&first, &second};
  for (std::int64_t row = overlap.rows.first; row < overlap.rows.end; ++row) {
    for (std::int64_t column = overlap.columns.first; column < overlap.columns.end; ++column) {
      const float value[2] = {ValueAt(first, column, row), ValueAt(second, column, row)};
      if (std::isnan(value[0]) || std::isnan(value[1])) continue;
      ++known;
      for (int i = 0; i < 2; ++i) {
        if (value[i] < limit.occupied) continue;
        ++walls[i];
        if (value[1 - i] > limit.free) continue;
        ++disagreeing;
        if (!HasWallNear(*maps[1 - i], column, row, reach, limit.occupied)) ++contradicted[i];
      }
    }
  }
  const auto share = [](std::int64_t part, std::int64_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  seam->overlap_area_m2 = static_cast<double>(known) * first.cell_size_m * first.cell_size_m;
  seam->disagreeing_share = share(disagreeing, known);
  seam->first_contradicted_share = share(contradicted[0], walls[0]);
  seam->second_contradicted_share = share(contradicted[1], walls[1]);
}

// Agreement of the faces of one window for every shift of the second map, in cells from -reach to reach.
class Agreement {
 public:
  Agreement(const FaceImage& first, const FaceImage& second, const Overlap& window, int reach)
      : reach_(reach), size_(2 * reach + 1), sums_(static_cast<std::size_t>(size_ * size_), 0.0) {
    for (std::int64_t row = window.rows.first; row < window.rows.end; ++row) {
      for (std::int64_t column = window.columns.first; column < window.columns.end; ++column) {
        AddCell(first, second, column, row);
      }
    }
  }

  double At(int dx, int dy) const { return sums_[static_cast<std::size_t>((dy + reach_) * size_ + dx + reach_)]; }

  // Correlation coefficient that a sum stands for.
  double Quality(double sum) const {
    const double norm = std::sqrt(first_norm_ * second_norm_);
    return norm > 0 ? sum / norm : 0.0;
  }
  double face_cells() const { return face_cells_; }

  // Shift of the highest sum, one cell within the border. Along a straight wall all sums are much the same: small
  // shifts get a slight preference.
  Eigen::Vector2i Peak() const {
    Eigen::Vector2i best(0, 0);
    double highest = 0.0;
    const int inner = reach_ - 1;
    for (int dy = -inner; dy <= inner; ++dy) {
      for (int dx = -inner; dx <= inner; ++dx) {
        const double score = At(dx, dy) * (1.0 - 0.05 * (dx * dx + dy * dy) / (inner * inner));
        if (score <= highest) continue;
        highest = score;
        best = {dx, dy};
      }
    }
    return best;
  }

 private:
  void AddCell(const FaceImage& first, const FaceImage& second, std::int64_t column, std::int64_t row) {
    // Each map's faces count where the other one has seen anything near: elsewhere nothing can agree.
    const Eigen::Vector2f b = second.At(column, row);
    if (b != Eigen::Vector2f::Zero() && first.KnownNear(column, row)) second_norm_ += b.squaredNorm();
    const Eigen::Vector2f a = first.At(column, row);
    if (a == Eigen::Vector2f::Zero() || !second.KnownNear(column, row)) return;
    first_norm_ += a.squaredNorm();
    face_cells_ += a.norm();
    std::size_t index = 0;
    for (int dy = -reach_; dy <= reach_; ++dy) {
      for (int dx = -reach_; dx <= reach_; ++dx, ++index) {
        // Faces that look opposite ways (negative) are two faces, not a contradiction.
        sums_[index] += std::max(0.0F, a.dot(second.At(column + dx, row + dy)));
      }
    }
  }

  int reach_;
  int size_;
  std::vector<double> sums_;
  double first_norm_ = 0.0;
  double second_norm_ = 0.0;
  double face_cells_ = 0.0;
};

// Second-order fit through the nine sums round the peak, in cells.
struct Parabola {
  Eigen::Vector2d gradient;
  Eigen::Matrix2d curvature;  // of minus the agreement: positive definite at a maximum
};

Parabola FitParabola(const Agreement& agreement, const Eigen::Vector2i& peak) {
  const auto at = [&](int dx, int dy) { return agreement.At(peak.x() + dx, peak.y() + dy); };
  const double centre = at(0, 0);
  Parabola fit;
  fit.gradient = {(at(1, 0) - at(-1, 0)) / 2, (at(0, 1) - at(0, -1)) / 2};
  const double xy = -(at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1)) / 4;
  fit.curvature << 2 * centre - at(1, 0) - at(-1, 0), xy, xy, 2 * centre - at(0, 1) - at(0, -1);
  return fit;
}

constexpr double kMinFaceCells = 20.0;      // a metre of wall
constexpr double kMinCurvatureRatio = 0.1;  // below: a straight wall, known across only

std::optional<SeamPatch> MeasureWindow(const FaceImage& first, const FaceImage& second, const Overlap& window,
                                       double cell_size_m, int reach, double min_quality) {
  const Agreement agreement(first, second, window, reach + 1);
  if (agreement.face_cells() < kMinFaceCells) return std::nullopt;
  const Eigen::Vector2i peak = agreement.Peak();
  const double quality = agreement.Quality(agreement.At(peak.x(), peak.y()));
  if (quality < min_quality) return std::nullopt;
  const Parabola parabola = FitParabola(agreement, peak);
  const PrincipalAxes principal = PrincipalAxesOf(parabola.curvature);
  const double weak = principal.values[0];
  const double strong = principal.values[1];
  if (strong <= 0) return std::nullopt;
  SeamPatch patch;
  patch.quality = std::min(quality, 1.0);
  patch.centre_in_site = cell_size_m / 2 *
                         Eigen::Vector2d(static_cast<double>(window.columns.first + window.columns.end),
                                         static_cast<double>(window.rows.first + window.rows.end));
  if (weak >= kMinCurvatureRatio * strong) {
    patch.directions = 2;
    patch.offset = cell_size_m * (peak.cast<double>() + parabola.curvature.ldlt().solve(parabola.gradient));
    patch.weight = parabola.curvature;
  } else {
    const Eigen::Vector2d across = principal.axes.col(1);
    patch.directions = 1;
    patch.offset = cell_size_m * across * (across.dot(peak.cast<double>()) + across.dot(parabola.gradient) / strong);
    patch.weight = strong * across * across.transpose();
  }
  // A best place at the end of the search is none.
  if (patch.offset.cwiseAbs().maxCoeff() > cell_size_m * (reach - 0.5)) return std::nullopt;
  return patch;
}

void CombinePatches(Seam* seam) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  double squares = 0.0;
  int full = 0;
  for (const SeamPatch& patch : seam->patches) {
    normal += patch.weight;
    right += patch.weight * patch.offset;
    if (patch.directions != 2) continue;
    squares += patch.offset.squaredNorm();
    ++full;
  }
  const Eigen::Vector2d strengths = PrincipalAxesOf(normal).values;
  if (strengths[0] > 0 && strengths[0] >= kMinCurvatureRatio / 2 * strengths[1])
    seam->offset = normal.ldlt().solve(right);
  if (full > 0) seam->rms_m = std::sqrt(squares / full);
}

std::int64_t FloorTo(std::int64_t value, std::int64_t step) { return FloorDivide(value, step) * step; }

}  // namespace

Seam CompareMaps(const SiteRaster& first, const SiteRaster& second, const SeamOptions& options) {
  Seam seam;
  const Overlap overlap{Common(first.min_column, first.width, second.min_column, second.width),
                        Common(first.min_row, first.height, second.min_row, second.height)};
  if (overlap.Empty()) return seam;
  CountCells(first, second, overlap, options, &seam);
  const int reach = static_cast<int>(std::lround(options.search_m / first.cell_size_m));
  const FaceImage first_faces(first, options.occupied_probability, options.free_probability, reach);
  const FaceImage second_faces(second, options.occupied_probability, options.free_probability, reach);
  // Windows on a fixed raster of the site, so that they stay where they are when a block grows.
  const std::int64_t step = std::max<std::int64_t>(1, std::llround(options.window_m / first.cell_size_m));
  for (std::int64_t row = FloorTo(overlap.rows.first, step); row < overlap.rows.end; row += step) {
    for (std::int64_t column = FloorTo(overlap.columns.first, step); column < overlap.columns.end; column += step) {
      const Overlap window{{column, column + step}, {row, row + step}};
      const auto patch =
          MeasureWindow(first_faces, second_faces, window, first.cell_size_m, reach, options.min_quality);
      if (patch) seam.patches.push_back(*patch);
    }
  }
  CombinePatches(&seam);
  return seam;
}

}  // namespace survey
