// SPDX-License-Identifier: Apache-2.0
#include "survey/features/pillar.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "survey/features/arc_share.h"
#include "survey/features/face_lines.h"
#include "survey/features/face_place.h"

namespace survey {
namespace {

using Eigen::Vector2d;

struct Centre {
  Vector2d p;  // from the surveyed place
  Eigen::Matrix2d covariance;
  double rms_m = 0.0;  // of the cells from the outline
  int num_cells = 0;
};

// Cells that look away from a place: the outside of something that stands there.
std::vector<FaceCell> LookingAwayFrom(const std::vector<FaceCell>& cells, const Vector2d& centre, double max_distance) {
  std::vector<FaceCell> outside;
  for (const FaceCell& cell : cells) {
    const Vector2d out = cell.p - centre;
    if (out.norm() <= max_distance && cell.normal.dot(out) > 0.5 * out.norm()) outside.push_back(cell);
  }
  return outside;
}

struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0.0;
};

// Algebraic circle fit (Kasa), which is exact enough for arcs beyond a half circle.
std::optional<Circle> FitCircle(const std::vector<HitCell>& cells) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const HitCell& cell : cells) {
    const Eigen::Vector3d row(cell.p.x(), cell.p.y(), 1.0);
    normal += cell.hits * row * row.transpose();
    right += cell.hits * cell.p.squaredNorm() * row;
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
  if (cells.size() < 6 || !solver.isInvertible()) return std::nullopt;
  const Eigen::Vector3d solution = solver.solve(right);
  Circle circle;
  circle.centre = solution.head<2>() / 2;
  const double square = solution(2) + circle.centre.squaredNorm();
  if (!(square > 0)) return std::nullopt;
  circle.radius = std::sqrt(square);
  return circle;
}

std::vector<Vector2d> PlacesOf(const std::vector<HitCell>& cells) {
  std::vector<Vector2d> places;
  for (const HitCell& cell : cells) places.push_back(cell.p);
  return places;
}

constexpr double kMinArcShare = 0.6;

std::vector<HitCell> OnCircle(std::span<const HitCell> hits, const Circle& circle, double half_width_m) {
  std::vector<HitCell> on;
  for (const HitCell& cell : hits) {
    if (std::abs((cell.p - circle.centre).norm() - circle.radius) <= half_width_m) on.push_back(cell);
  }
  return on;
}

// Of the radius: the outline rolled out to a straight face.
std::optional<double> RadiusVariance(const std::vector<HitCell>& outline, const Circle& circle, double cell_size_m) {
  std::vector<HitCell> rolled;
  for (const HitCell& cell : outline) {
    const Vector2d out = cell.p - circle.centre;
    rolled.push_back({{out.norm() - circle.radius, circle.radius * std::atan2(out.y(), out.x())}, cell.hits});
  }
  const double half_turn = std::numbers::pi * circle.radius;
  const auto place = PlaceFace(rolled, {.from = -half_turn, .to = half_turn}, cell_size_m);
  if (!place) return std::nullopt;
  return place->sigma_offset * place->sigma_offset;
}

std::optional<Centre> RoundCentre(const std::vector<FaceCell>& cells, std::span<const HitCell> hits, double cell_size_m,
                                  double max_radius_m) {
  std::vector<HitCell> outline;
  for (const FaceCell& cell : cells) outline.push_back({cell.p, cell.weight});
  std::optional<Circle> circle;
  for (int round = 0; round < 3; ++round) {  // the wall's cells, then the hits about their circle
    circle = FitCircle(outline);
    if (!circle || circle->radius > max_radius_m || ArcShare(PlacesOf(outline), circle->centre) < kMinArcShare)
      return std::nullopt;
    outline = OnCircle(hits, *circle, 1.5 * cell_size_m);
  }
  const std::optional<double> variance = RadiusVariance(outline, *circle, cell_size_m);
  if (!variance) return std::nullopt;
  double squares = 0.0;
  double weight = 0.0;
  for (const FaceCell& cell : cells) {
    squares += cell.weight * std::pow((cell.p - circle->centre).norm() - circle->radius, 2);
    weight += cell.weight;
  }
  // The cosine of the direction, which moves the centre, is on average half as large a square as the radius' one.
  return Centre{circle->centre, 2.0 * *variance * Eigen::Matrix2d::Identity(), std::sqrt(squares / weight),
                static_cast<int>(cells.size())};
}

// Two faces that look opposite ways, with the middle between them along the first one's normal.
struct OppositeFaces {
  Vector2d normal;
  double middle = 0.0;
  double size = 0.0;
  double variance = 0.0;
};

std::optional<OppositeFaces> FindOpposite(const std::vector<FaceLine>& lines, double max_size_m, double min_cosine_to,
                                          const Vector2d& direction) {
  std::optional<OppositeFaces> best;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      if (lines[i].normal.dot(lines[j].normal) > -0.96) continue;
      const Vector2d normal = (lines[i].normal - lines[j].normal).normalized();
      if (std::abs(normal.dot(direction)) < min_cosine_to) continue;
      const double size = lines[i].offset + lines[j].offset;
      if (size <= 0 || size > max_size_m) continue;
      if (best && best->size <= size) continue;
      best = {normal, (lines[i].offset - lines[j].offset) / 2, size,
              (std::pow(lines[i].sigma_offset, 2) + std::pow(lines[j].sigma_offset, 2)) / 4};
    }
  }
  return best;
}

// Middle of a square across the direction in which both faces are seen: from both faces, or from one and the size.
std::optional<OppositeFaces> AcrossOf(const std::vector<FaceLine>& lines, const OppositeFaces& known, double max_size) {
  const Vector2d across(-known.normal.y(), known.normal.x());
  if (auto both = FindOpposite(lines, max_size, 0.96, across)) return both;
  for (const FaceLine& line : lines) {
    if (std::abs(line.normal.dot(across)) < 0.96) continue;
    return OppositeFaces{line.normal, line.offset - known.size / 2, known.size,
                         std::pow(line.sigma_offset, 2) + known.variance};
  }
  return std::nullopt;
}

std::optional<Centre> SquareCentre(const std::vector<FaceCell>& cells, std::span<const HitCell> hits,
                                   double cell_size_m, double max_size_m) {
  const std::vector<FaceLine> lines = FindFaceLines(cells, hits, cell_size_m, {.min_length_m = 0.15, .max_lines = 6});
  const auto first = FindOpposite(lines, max_size_m, 0.0, Vector2d::UnitX());
  if (!first) return std::nullopt;
  const auto second = AcrossOf(lines, *first, max_size_m);
  if (!second) return std::nullopt;
  Eigen::Matrix2d normals;
  normals << first->normal.transpose(), second->normal.transpose();
  const Eigen::Matrix2d inverse = normals.inverse();
  const Vector2d variances(first->variance, second->variance);
  Centre centre{inverse * Vector2d(first->middle, second->middle),
                inverse * variances.asDiagonal() * inverse.transpose()};
  double squares = 0.0;
  double weight = 0.0;
  for (const FaceCell& cell : cells) {
    const double u = std::abs(first->normal.dot(cell.p) - first->middle) - first->size / 2;
    const double v = std::abs(second->normal.dot(cell.p) - second->middle) - second->size / 2;
    squares += cell.weight * std::pow(std::max(u, v), 2);
    weight += cell.weight;
  }
  centre.rms_m = std::sqrt(squares / weight);
  centre.num_cells = static_cast<int>(cells.size());
  return centre;
}

}  // namespace

MapFeature LocatePillar(const SiteRaster& map, const HitCells& hits, const NamedFeature& wanted,
                        const LocateOptions& options) {
  MapFeature feature;
  const double reach = options.PillarReach();
  const std::vector<FaceCell> all = FaceCellsNear(map, wanted.position_in_site, reach);
  const std::vector<HitCell> near = hits.Near(wanted.position_in_site, reach);
  std::optional<Centre> best;
  Vector2d about = Vector2d::Zero();
  // Twice: the outside of the pillar is known better from its own centre than from the surveyed one.
  for (int round = 0; round < 2; ++round) {
    const std::vector<FaceCell> cells =
        LookingAwayFrom(all, about, options.max_pillar_size_m * std::numbers::sqrt2 / 2);
    if (cells.empty()) break;
    best = RoundCentre(cells, near, map.cell_size_m, options.max_pillar_size_m / 2);
    const auto square = SquareCentre(cells, near, map.cell_size_m, options.max_pillar_size_m);
    if (square && (!best || square->rms_m < best->rms_m)) best = square;
    if (!best) break;
    about = best->p;
  }
  if (!best) {
    feature.reason = all.empty() ? "no wall of the map lies near" : "too little of the pillar's outline is seen";
  } else if (best->p.norm() > options.search_radius_m) {
    feature.reason = "no pillar within the search radius";
  } else if (best->rms_m > map.cell_size_m) {
    feature.reason = "what stands there is neither square nor round";
  } else {
    feature.position_in_site = wanted.position_in_site + best->p;
    feature.reading = best->covariance;
    feature.num_cells = best->num_cells;
  }
  return feature;
}

}  // namespace survey
