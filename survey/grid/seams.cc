// SPDX-License-Identifier: Apache-2.0
#include "survey/grid/seams.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "survey/geometry/principal_axes.h"
#include "survey/grid/coverage.h"
#include "survey/grid/faces.h"

namespace survey {
namespace {

// Of a site cell of the raster.
std::size_t IndexOf(const SiteRaster& raster, std::int64_t site_column, std::int64_t site_row) {
  return raster.Index(static_cast<int>(site_column - raster.min_column), static_cast<int>(site_row - raster.min_row));
}

// Value at a site cell; NaN outside.
float ValueAt(const SiteRaster& raster, std::int64_t site_column, std::int64_t site_row) {
  if (!raster.Contains(site_column - raster.min_column, site_row - raster.min_row)) return kUnknownLogOdds;
  return raster.log_odds[IndexOf(raster, site_column, site_row)];
}

// The cells of a site row from a site column of the raster on.
const float* CellsFrom(const SiteRaster& raster, std::int64_t site_column, std::int64_t site_row) {
  return raster.log_odds.data() + IndexOf(raster, site_column, site_row);
}

// Whether some cell within so many columns and rows was observed.
bool KnownNear(const SiteRaster& raster, std::int64_t site_column, std::int64_t site_row, int near) {
  if (!std::isnan(ValueAt(raster, site_column, site_row))) return true;
  const CellBox cell{site_column, site_row, site_column + 1, site_row + 1};
  const SiteRaster part = FrameWithin(raster, cell, near);
  for (int row = 0; row < part.height; ++row) {
    const float* from = CellsFrom(raster, part.min_column, part.min_row + row);
    if (!std::all_of(from, from + part.width, [](float value) { return std::isnan(value); })) return true;
  }
  return false;
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

void CountCells(const SiteRaster& first, const SiteRaster& second, const CellBox& overlap, const SeamOptions& options,
                Seam* seam) {
  const Thresholds limit{LogOddsOf(options.occupied_probability), LogOddsOf(options.free_probability)};
  const int reach = static_cast<int>(std::lround(options.wall_tolerance_m / first.cell_size_m));
  std::int64_t known = 0;
  std::int64_t disagreeing = 0;
  std::int64_t walls[2] = {0, 0};
  std::int64_t contradicted[2] = {0, 0};
  const SiteRaster* maps[2] = {&first, &second};
  for (std::int64_t row = overlap.min_row; row < overlap.end_row; ++row) {
    const float* cells[2] = {CellsFrom(first, overlap.min_column, row), CellsFrom(second, overlap.min_column, row)};
    for (std::int64_t column = overlap.min_column; column < overlap.end_column; ++column) {
      const float value[2] = {*cells[0]++, *cells[1]++};
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

// The faces of a map in a window: visit(index of the cell, site column, site row).
template <typename Visit>
void ForEachFace(const FacedRaster& raster, const CellBox& window, const Visit& visit) {
  const SiteRaster part = FrameWithin(raster.map, window, 0);
  for (std::int64_t row = part.min_row; row < part.min_row + part.height; ++row) {
    std::size_t i = IndexOf(raster.map, part.min_column, row);
    for (std::int64_t column = part.min_column; column < part.min_column + part.width; ++column, ++i) {
      if (raster.face_x[i] != 0.0F || raster.face_y[i] != 0.0F) visit(i, column, row);
    }
  }
}

// Agreement of the faces of one window for every shift of the second map, in cells from -reach to reach. Each map's
// faces count where the other one has seen anything within `near` cells: elsewhere nothing can agree.
class Agreement {
 public:
  Agreement(const FacedRaster& first, const FacedRaster& second, const CellBox& window, int near, int reach)
      : reach_(reach), size_(2 * reach + 1), sums_(static_cast<std::size_t>(size_ * size_), 0.0) {
    ForEachFace(second, window, [&](std::size_t i, std::int64_t column, std::int64_t row) {
      if (KnownNear(first.map, column, row, near))
        second_norm_ += Eigen::Vector2f(second.face_x[i], second.face_y[i]).squaredNorm();
    });
    ForEachFace(first, window, [&](std::size_t i, std::int64_t column, std::int64_t row) {
      if (!KnownNear(second.map, column, row, near)) return;
      const Eigen::Vector2f face(first.face_x[i], first.face_y[i]);
      first_norm_ += face.squaredNorm();
      face_cells_ += face.norm();
      AddShifts(face, second, column, row);
    });
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
  // Faces that look opposite ways (negative) are two faces, not a contradiction.
  void AddShifts(const Eigen::Vector2f& face, const FacedRaster& second, std::int64_t column, std::int64_t row) {
    const SiteRaster within = FrameWithin(second.map, {column, row, column + 1, row + 1}, reach_);
    for (std::int64_t r = within.min_row; r < within.min_row + within.height; ++r) {
      const std::size_t from = IndexOf(second.map, within.min_column, r);
      const float* x = &second.face_x[from];
      const float* y = &second.face_y[from];
      double* sums = &sums_[static_cast<std::size_t>((r - row + reach_) * size_ + within.min_column - column + reach_)];
      for (int i = 0; i < within.width; ++i) sums[i] += std::max(0.0F, face.x() * x[i] + face.y() * y[i]);
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

std::optional<SeamPatch> MeasureWindow(const FacedRaster& first, const FacedRaster& second, const CellBox& window,
                                       int reach, double min_quality) {
  const double cell_size_m = first.map.cell_size_m;
  const Agreement agreement(first, second, window, reach, reach + 1);
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
                         Eigen::Vector2d(static_cast<double>(window.min_column + window.end_column),
                                         static_cast<double>(window.min_row + window.end_row));
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

int SearchCells(const SeamOptions& options, double cell_size_m) {
  return static_cast<int>(std::lround(options.search_m / cell_size_m));
}

std::int64_t FloorTo(std::int64_t value, std::int64_t step) { return FloorDivide(value, step) * step; }

}  // namespace

FacedRaster WithFaces(SiteRaster map, const SeamOptions& options) {
  const FaceImage faces(map, options.occupied_probability, options.free_probability);
  return {.map = std::move(map), .face_x = faces.x(), .face_y = faces.y()};
}

std::int64_t SeamMarginCells(const SeamOptions& options, double cell_size_m) {
  // Faces so near to what the other map has seen count, and are sought one cell further.
  return 2 * SearchCells(options, cell_size_m) + 1;
}

Seam CompareMaps(const FacedRaster& first, const FacedRaster& second, const SeamOptions& options) {
  Seam seam;
  const CellBox overlap = BoxOf(FrameWithin(first.map, BoxOf(second.map), 0));
  if (overlap.min_column >= overlap.end_column) return seam;
  CountCells(first.map, second.map, overlap, options, &seam);
  const double cell_size_m = first.map.cell_size_m;
  const int reach = SearchCells(options, cell_size_m);
  // Windows on a fixed raster of the site, so that they stay where they are when a block grows.
  const std::int64_t step = std::max<std::int64_t>(1, std::llround(options.window_m / cell_size_m));
  for (std::int64_t row = FloorTo(overlap.min_row, step); row < overlap.end_row; row += step) {
    for (std::int64_t column = FloorTo(overlap.min_column, step); column < overlap.end_column; column += step) {
      const CellBox window{column, row, column + step, row + step};
      const auto patch = MeasureWindow(first, second, window, reach, options.min_quality);
      if (patch) seam.patches.push_back(*patch);
    }
  }
  CombinePatches(&seam);
  return seam;
}

Seam CompareMaps(const SiteRaster& first, const SiteRaster& second, const SeamOptions& options) {
  return CompareMaps(WithFaces(first, options), WithFaces(second, options), options);
}

}  // namespace survey
