// SPDX-License-Identifier: Apache-2.0
#include "survey/features/face_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "survey/features/face_place.h"
#include "survey/geometry/principal_axes.h"
#include "survey/grid/faces.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr double kOccupied = 0.65;
constexpr double kFree = 0.35;
constexpr double kMinCosine = 0.6;
constexpr double kOwnCosine = 0.8;  // cells at a corner look between its faces and belong to both
constexpr int kDirections = 180;
constexpr double kScattersTrimmed = 4.0;  // of the ends of a face
constexpr double kMostTrimmed = 0.25;     // of its length

// The part of a raster round a cell.
SiteRaster Crop(const SiteRaster& raster, const Vector2d& centre, double radius_m) {
  const auto middle = raster.CellOf(centre);
  const std::int64_t reach = std::llround(radius_m / raster.cell_size_m) + kFaceReachCells;
  const std::int64_t first_column = std::max<std::int64_t>(0, middle.x() - reach);
  const std::int64_t first_row = std::max<std::int64_t>(0, middle.y() - reach);
  const std::int64_t end_column = std::min<std::int64_t>(raster.width, middle.x() + reach + 1);
  const std::int64_t end_row = std::min<std::int64_t>(raster.height, middle.y() + reach + 1);
  SiteRaster part{.cell_size_m = raster.cell_size_m,
                  .min_column = raster.min_column + first_column,
                  .min_row = raster.min_row + first_row};
  if (first_column >= end_column || first_row >= end_row) return part;
  part.width = static_cast<int>(end_column - first_column);
  part.height = static_cast<int>(end_row - first_row);
  for (std::int64_t row = first_row; row < end_row; ++row) {
    for (std::int64_t column = first_column; column < end_column; ++column) {
      part.log_odds.push_back(raster.At(static_cast<int>(column), static_cast<int>(row)));
    }
  }
  return part;
}

struct Candidate {
  Vector2d normal;
  double offset = 0.0;
  double weight = 0.0;
};

// The direction and offset with the most wall within a cell.
Candidate BestCandidate(const std::vector<FaceCell>& cells, double cell_size_m) {
  Candidate best;
  const double step = cell_size_m / 2;
  std::vector<double> bins;
  for (int direction = 0; direction < kDirections; ++direction) {
    const double angle = 2.0 * std::numbers::pi * direction / kDirections;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    double reach = 0.0;
    for (const FaceCell& cell : cells) reach = std::max(reach, std::abs(normal.dot(cell.p)));
    const int half = static_cast<int>(reach / step) + 2;
    bins.assign(static_cast<std::size_t>(2 * half + 1), 0.0);
    for (const FaceCell& cell : cells) {
      const double cosine = normal.dot(cell.normal);
      if (cosine < kMinCosine) continue;
      const int bin = static_cast<int>(std::lround(normal.dot(cell.p) / step)) + half;
      bins[static_cast<std::size_t>(bin)] += cell.weight * cosine;
    }
    for (int bin = 1; bin + 1 < static_cast<int>(bins.size()); ++bin) {
      const std::size_t i = static_cast<std::size_t>(bin);
      const double weight = bins[i - 1] + bins[i] + bins[i + 1];
      if (weight > best.weight + 1e-9) best = {normal, (bin - half) * step, weight};
    }
  }
  return best;
}

// Cells of a line: in its band, looking its way, in the longest stretch without a gap.
struct Band {
  std::vector<std::size_t> cells;
  double begin = 0.0;
  double end = 0.0;
};

Band BandOf(const std::vector<FaceCell>& cells, const Vector2d& normal, double offset, double half_width,
            double max_gap, double min_cosine) {
  const Vector2d along(-normal.y(), normal.x());
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (std::abs(normal.dot(cells[i].p) - offset) <= half_width && normal.dot(cells[i].normal) >= min_cosine)
      inside.push_back(i);
  }
  const auto place = [&](std::size_t i) { return along.dot(cells[i].p); };
  std::sort(inside.begin(), inside.end(),
            [&](std::size_t a, std::size_t b) { return place(a) != place(b) ? place(a) < place(b) : a < b; });
  Band best;
  double best_weight = 0.0;
  for (std::size_t first = 0; first < inside.size();) {
    std::size_t end = first + 1;
    double weight = cells[inside[first]].weight;
    while (end < inside.size() && place(inside[end]) - place(inside[end - 1]) <= max_gap) {
      weight += cells[inside[end++]].weight;
    }
    if (weight > best_weight) {
      best_weight = weight;
      best = {{inside.begin() + static_cast<std::ptrdiff_t>(first), inside.begin() + static_cast<std::ptrdiff_t>(end)},
              place(inside[first]),
              place(inside[end - 1])};
    }
    first = end;
  }
  return best;
}

// The ends of a face belong to corners: their cells are smeared round them.
double TrimOf(double length, double cell_size_m) { return std::min(1.5 * cell_size_m, 0.2 * length); }

// Weighted total least squares: the middle of the band.
std::optional<FaceLine> FitBand(const std::vector<FaceCell>& cells, const Band& band, const Vector2d& towards,
                                double cell_size_m) {
  const double trim = TrimOf(band.end - band.begin, cell_size_m);
  const Vector2d along(-towards.y(), towards.x());
  double weight = 0.0;
  Vector2d mean = Vector2d::Zero();
  std::vector<std::size_t> used;
  for (const std::size_t i : band.cells) {
    const double place = along.dot(cells[i].p);
    if (place < band.begin + trim || place > band.end - trim) continue;
    used.push_back(i);
    weight += cells[i].weight;
    mean += cells[i].weight * cells[i].p;
  }
  if (used.size() < 3 || weight <= 0) return std::nullopt;
  mean /= weight;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const std::size_t i : used) {
    scatter += cells[i].weight * (cells[i].p - mean) * (cells[i].p - mean).transpose();
  }
  FaceLine line;
  line.normal = PrincipalAxesOf(scatter / weight).axes.col(0);
  if (line.normal.dot(towards) < 0) line.normal = -line.normal;
  line.begin = band.begin;
  line.end = band.end;
  line.num_cells = static_cast<int>(used.size());
  line.offset = line.normal.dot(mean);
  return line;
}

std::optional<FaceLine> Refine(const std::vector<FaceCell>& cells, const Candidate& candidate, double cell_size_m) {
  Vector2d normal = candidate.normal;
  double offset = candidate.offset;
  std::optional<FaceLine> line;
  for (int round = 0; round < 3; ++round) {
    const Band band = BandOf(cells, normal, offset, 2.0 * cell_size_m, 3.0 * cell_size_m, kMinCosine);
    line = FitBand(cells, band, normal, cell_size_m);
    if (!line) return std::nullopt;
    normal = line->normal;
    offset = line->offset;
  }
  return line;
}

// From the middle of the band to the face; false where it has no hits.
bool PlaceByHits(std::span<const HitCell> hits, double cell_size_m, FaceLine* line) {
  std::optional<FacePlace> place;
  double trim = TrimOf(line->Length(), cell_size_m);
  for (int round = 0; round < 2; ++round) {
    place = PlaceFace(
        hits, {.normal = line->normal, .offset = line->offset, .from = line->begin + trim, .to = line->end - trim},
        cell_size_m);
    if (!place) return false;
    // Hits on the next face scatter as well, and some of them end up behind this one.
    trim = std::max(trim, std::min(kScattersTrimmed * place->scatter, kMostTrimmed * line->Length()));
  }
  line->normal = place->normal;
  line->offset = place->offset;
  line->middle = place->middle;
  line->sigma_offset = place->sigma_offset;
  line->sigma_angle = place->sigma_angle;
  return true;
}

}  // namespace

double FaceLine::SigmaAt(double along) const { return std::hypot(sigma_offset, sigma_angle * (along - middle)); }

std::vector<FaceCell> FaceCellsNear(const SiteRaster& raster, const Vector2d& p_in_site, double radius_m) {
  const SiteRaster part = Crop(raster, p_in_site, radius_m);
  std::vector<FaceCell> cells;
  if (part.width == 0) return cells;
  const FaceImage faces(part, kOccupied, kFree);
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      const float log_odds = part.At(column, row);
      if (std::isnan(log_odds)) continue;
      const double weight = std::clamp((static_cast<double>(ProbabilityFromLogOdds(log_odds)) - 0.5) / 0.4, 0.0, 1.0);
      const Vector2d p = part.CentreOf(column, row) - p_in_site;
      const Eigen::Vector2f normal = faces.At(part.min_column + column, part.min_row + row);
      if (weight == 0 || p.norm() > radius_m || normal.norm() < 0.05F) continue;
      cells.push_back({p, normal.cast<double>().normalized(), weight});
    }
  }
  return cells;
}

std::vector<FaceLine> FindFaceLines(std::vector<FaceCell> cells, std::span<const HitCell> hits, double cell_size_m,
                                    const FaceLineOptions& options) {
  std::vector<FaceLine> lines;
  for (int attempt = 0; attempt < 2 * options.max_lines && static_cast<int>(lines.size()) < options.max_lines;
       ++attempt) {
    const Candidate candidate = BestCandidate(cells, cell_size_m);
    if (candidate.weight * cell_size_m < options.min_length_m / 2) break;
    std::optional<FaceLine> line = Refine(cells, candidate, cell_size_m);
    const Vector2d normal = line ? line->normal : candidate.normal;
    const double offset = line ? line->offset : candidate.offset;
    const Band taken = BandOf(cells, normal, offset, 2.5 * cell_size_m, 3.0 * cell_size_m, kOwnCosine);
    if (taken.cells.empty()) break;
    if (line && line->Length() >= options.min_length_m && PlaceByHits(hits, cell_size_m, &*line))
      lines.push_back(*line);
    std::vector<bool> gone(cells.size(), false);
    for (const std::size_t i : taken.cells) gone[i] = true;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!gone[i]) cells[kept++] = cells[i];
    }
    cells.resize(kept);
  }
  return lines;
}

}  // namespace survey
