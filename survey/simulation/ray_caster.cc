// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/ray_caster.h"

#include <algorithm>
#include <cmath>

#include "survey/geometry/segment.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr double kCell = 1.0;

// Ray origin + t direction meets a + s d: t, or infinity when they miss each other.
double RangeToSegment(const Vector2d& origin, const Vector2d& direction, const Vector2d& a, const Vector2d& d) {
  const double denominator = Cross(direction, d);
  const Vector2d to_a = a - origin;
  const double s = Cross(to_a, direction);
  // 0 <= s / denominator <= 1 without the division.
  if (denominator > 0 ? (s < 0 || s > denominator) : (s > 0 || s < denominator)) return kNever;
  if (denominator == 0) return kNever;
  const double t = Cross(to_a, d) / denominator;
  return t > 0 ? t : kNever;
}

struct Extent {
  Vector2d low = Vector2d::Constant(kNever);
  Vector2d high = Vector2d::Constant(-kNever);
  void Add(const Vector2d& p, double margin) {
    low = low.cwiseMin(p - Vector2d::Constant(margin));
    high = high.cwiseMax(p + Vector2d::Constant(margin));
  }
};

// True when the segment passes through the (slightly widened) cell: the cell's corners are not all on one side.
bool Touches(const Vector2d& a, const Vector2d& d, const Vector2d& centre) {
  const double side = Cross(d, centre - a);
  const double reach = (std::abs(d.x()) + std::abs(d.y())) * (kCell / 2 + 1e-6);
  return std::abs(side) <= reach;
}

}  // namespace

double RangeToDisc(const Vector2d& origin, const Vector2d& direction, const Disc& disc) {
  const Vector2d to_centre = disc.centre - origin;
  const double along = to_centre.dot(direction);
  const double distance2 = to_centre.squaredNorm();
  const double radius2 = disc.radius_m * disc.radius_m;
  if (along <= 0 || distance2 <= radius2) return kNever;
  const double inside2 = radius2 - (distance2 - along * along);
  return inside2 < 0 ? kNever : along - std::sqrt(inside2);
}

RayCaster::RayCaster(const FloorPlan& plan) {
  std::vector<Segment> segments;
  std::vector<Disc> discs;
  std::vector<PaneSegment> panes;
  Extent extent;
  for (const std::vector<Face>* faces : {&plan.solid_faces, &plan.car_faces}) {
    for (const Face& face : *faces) segments.push_back({face.a, face.b - face.a});
  }
  for (const Pane& pane : plan.panes) panes.push_back({{pane.a, pane.b - pane.a}, pane.response});
  for (const std::vector<Disc>* all : {&plan.pillar_discs, &plan.car_discs}) {
    discs.insert(discs.end(), all->begin(), all->end());
  }
  for (const Segment& segment : segments) {
    extent.Add(segment.a, 0.01);
    extent.Add(segment.a + segment.d, 0.01);
  }
  for (const PaneSegment& pane : panes) {
    extent.Add(pane.segment.a, 0.01);
    extent.Add(pane.segment.a + pane.segment.d, 0.01);
  }
  for (const Disc& disc : discs) extent.Add(disc.centre, disc.radius_m + 0.01);
  if (!(extent.low.x() <= extent.high.x())) return;

  corner_ = extent.low;
  width_ = static_cast<int>(std::ceil((extent.high.x() - extent.low.x()) / kCell)) + 1;
  height_ = static_cast<int>(std::ceil((extent.high.y() - extent.low.y()) / kCell)) + 1;
  const std::size_t count = Index(0, height_);
  std::vector<std::vector<std::size_t>> segments_of(count);
  std::vector<std::vector<std::size_t>> discs_of(count);
  std::vector<std::vector<std::size_t>> panes_of(count);
  const auto scatter = [&](const Segment& segment, std::size_t id, std::vector<std::vector<std::size_t>>* into) {
    const Vector2d b = segment.a + segment.d;
    const std::array<int, 4> range = CellsAround(segment.a.cwiseMin(b), segment.a.cwiseMax(b));
    for (int row = range[1]; row <= range[3]; ++row) {
      for (int column = range[0]; column <= range[2]; ++column) {
        const Vector2d centre = corner_ + kCell * Vector2d(column + 0.5, row + 0.5);
        if (Touches(segment.a, segment.d, centre)) (*into)[Index(column, row)].push_back(id);
      }
    }
  };
  for (std::size_t i = 0; i < segments.size(); ++i) scatter(segments[i], i, &segments_of);
  for (std::size_t i = 0; i < panes.size(); ++i) scatter(panes[i].segment, i, &panes_of);
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Vector2d reach = Vector2d::Constant(discs[i].radius_m);
    const std::array<int, 4> range = CellsAround(discs[i].centre - reach, discs[i].centre + reach);
    for (int row = range[1]; row <= range[3]; ++row) {
      for (int column = range[0]; column <= range[2]; ++column) discs_of[Index(column, row)].push_back(i);
    }
  }
  cells_.resize(count + 1);
  for (std::size_t cell = 0; cell < count; ++cell) {
    for (const std::size_t id : segments_of[cell]) segments_.push_back(segments[id]);
    for (const std::size_t id : discs_of[cell]) discs_.push_back(discs[id]);
    for (const std::size_t id : panes_of[cell]) panes_.push_back(panes[id]);
    cells_[cell + 1] = {static_cast<std::uint32_t>(segments_.size()), static_cast<std::uint32_t>(discs_.size()),
                        static_cast<std::uint32_t>(panes_.size())};
  }
}

std::array<int, 4> RayCaster::CellsAround(const Vector2d& low, const Vector2d& high) const {
  const auto clamp = [](double cell, int size) {
    return static_cast<int>(std::clamp(std::floor(cell), 0.0, static_cast<double>(size - 1)));
  };
  constexpr double kMargin = 1e-6;
  return {clamp((low.x() - corner_.x()) / kCell - kMargin, width_),
          clamp((low.y() - corner_.y()) / kCell - kMargin, height_),
          clamp((high.x() - corner_.x()) / kCell + kMargin, width_),
          clamp((high.y() - corner_.y()) / kCell + kMargin, height_)};
}

void RayCaster::HitCell(const Cell& cell, const Cell& next, const Vector2d& origin, const Vector2d& direction,
                        RayHit* hit) const {
  for (std::uint32_t i = cell.segments; i < next.segments; ++i) {
    hit->range_m = std::min(hit->range_m, RangeToSegment(origin, direction, segments_[i].a, segments_[i].d));
  }
  for (std::uint32_t i = cell.discs; i < next.discs; ++i) {
    hit->range_m = std::min(hit->range_m, RangeToDisc(origin, direction, discs_[i]));
  }
  for (std::uint32_t i = cell.panes; i < next.panes; ++i) {
    const double range = RangeToSegment(origin, direction, panes_[i].segment.a, panes_[i].segment.d);
    if (range == kNever) continue;
    // A pane lies in several cells; it counts once. Cells come in order, so only neighbours need sorting.
    int place = hit->num_panes;
    while (place > 0 && hit->panes[static_cast<std::size_t>(place - 1)].range_m > range) --place;
    if (place > 0 && hit->panes[static_cast<std::size_t>(place - 1)].range_m == range) continue;
    if (hit->num_panes == static_cast<int>(hit->panes.size())) continue;
    for (int j = hit->num_panes; j > place; --j)
      hit->panes[static_cast<std::size_t>(j)] = hit->panes[static_cast<std::size_t>(j - 1)];
    hit->panes[static_cast<std::size_t>(place)] = {range, panes_[i].response};
    ++hit->num_panes;
  }
}

RayHit RayCaster::Cast(const Vector2d& origin, const Vector2d& direction, double reach_m) const {
  RayHit hit;
  const Vector2d start = (origin - corner_) / kCell;
  std::array<int, 2> cell{};
  std::array<int, 2> step{};
  std::array<double, 2> next_range{};
  std::array<double, 2> range_per_cell{};
  const std::array<int, 2> size = {width_, height_};
  for (int axis = 0; axis < 2; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    cell[k] = static_cast<int>(std::floor(start[axis]));
    if (cell[k] < 0 || cell[k] >= size[k]) return hit;  // rays begin inside the building
    step[k] = direction[axis] > 0 ? 1 : -1;
    range_per_cell[k] = direction[axis] == 0 ? kNever : kCell / std::abs(direction[axis]);
    const double to_border = direction[axis] > 0 ? cell[k] + 1 - start[axis] : start[axis] - cell[k];
    next_range[k] = direction[axis] == 0 ? kNever : to_border * range_per_cell[k];
  }
  while (true) {
    const std::size_t index = Index(cell[0], cell[1]);
    HitCell(cells_[index], cells_[index + 1], origin, direction, &hit);
    const std::size_t k = next_range[0] < next_range[1] ? 0 : 1;
    if (hit.range_m <= next_range[k] || next_range[k] > reach_m) break;
    cell[k] += step[k];
    if (cell[k] < 0 || cell[k] >= size[k]) break;
    next_range[k] += range_per_cell[k];
  }
  if (hit.range_m > reach_m) hit.range_m = kNever;
  const double end = std::min(hit.range_m, reach_m);
  while (hit.num_panes > 0 && hit.panes[static_cast<std::size_t>(hit.num_panes - 1)].range_m > end) --hit.num_panes;
  return hit;
}

double RayCaster::Clearance(const Vector2d& position, double reach_m) const {
  const Vector2d reach = Vector2d::Constant(reach_m);
  const std::array<int, 4> range = CellsAround(position - reach, position + reach);
  double nearest = reach_m;
  for (int row = range[1]; row <= range[3]; ++row) {
    for (int column = range[0]; column <= range[2]; ++column) {
      const Cell& cell = cells_[Index(column, row)];
      const Cell& next = cells_[Index(column, row) + 1];
      for (std::uint32_t i = cell.segments; i < next.segments; ++i)
        nearest = std::min(nearest, DistanceToSegment(position, segments_[i].a, segments_[i].a + segments_[i].d));
      for (std::uint32_t i = cell.panes; i < next.panes; ++i)
        nearest = std::min(nearest,
                           DistanceToSegment(position, panes_[i].segment.a, panes_[i].segment.a + panes_[i].segment.d));
      for (std::uint32_t i = cell.discs; i < next.discs; ++i)
        nearest = std::min(nearest, std::max(0.0, (position - discs_[i].centre).norm() - discs_[i].radius_m));
    }
  }
  return nearest;
}

}  // namespace survey
