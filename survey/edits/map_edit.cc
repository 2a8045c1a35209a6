// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/map_edit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "survey/geometry/segment.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using Ring = std::vector<Vector2d>;

bool IsOnLine(const MapEdit& edit, double half_width, const Vector2d& p) {
  for (const Ring& line : edit.parts) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      if (DistanceToSegment(p, line[i], line[i + 1]) <= half_width) return true;
    }
  }
  return false;
}

struct Bounds {
  Vector2d low;
  Vector2d high;
};

Bounds BoundsOf(const MapEdit& edit) {
  Bounds bounds{edit.parts.front().front(), edit.parts.front().front()};
  for (const Ring& part : edit.parts) {
    for (const Vector2d& p : part) {
      bounds.low = bounds.low.cwiseMin(p);
      bounds.high = bounds.high.cwiseMax(p);
    }
  }
  return bounds;
}

double Distance(const Bounds& bounds, const SiteRaster& raster) {
  return (LowCornerOf(raster) - bounds.high).cwiseMax(bounds.low - HighCornerOf(raster)).cwiseMax(0.0).norm();
}

float LogOddsOf(CellState state) {
  if (state == CellState::kUnknown) return kUnknownLogOdds;
  return state == CellState::kOccupied ? kEditedLogOdds : -kEditedLogOdds;
}

bool IsSame(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

double HalfWidth(const MapEdit& edit, double cell_size_m) {
  return edit.width_m.value_or(std::numbers::sqrt2 * cell_size_m) / 2;
}

// The cells of a line or of rings that belong together.
void VisitShape(const MapEdit& edit, const SiteRaster& raster, const CellVisitor& visit) {
  const double half_width = HalfWidth(edit, raster.cell_size_m);
  const Bounds bounds = BoundsOf(edit);
  const Vector2d margin = Vector2d::Constant(IsArea(edit.kind) ? 0.0 : half_width);
  const auto first = raster.CellOf(bounds.low - margin);
  const auto last = raster.CellOf(bounds.high + margin);
  const int end_column = static_cast<int>(std::min<std::int64_t>(last.x() + 1, raster.width));
  const int end_row = static_cast<int>(std::min<std::int64_t>(last.y() + 1, raster.height));
  for (int row = static_cast<int>(std::max<std::int64_t>(first.y(), 0)); row < end_row; ++row) {
    for (int column = static_cast<int>(std::max<std::int64_t>(first.x(), 0)); column < end_column; ++column) {
      const Vector2d centre = raster.CentreOf(column, row);
      if (IsArea(edit.kind) ? IsInside(edit, centre) : IsOnLine(edit, half_width, centre)) visit(column, row);
    }
  }
}

struct Edge {
  Vector2d begin;
  Vector2d end;
  std::size_t ring;
  std::size_t index;
};

std::vector<Edge> EdgesOf(const MapEdit& edit) {
  std::vector<Edge> edges;
  for (std::size_t r = 0; r < edit.parts.size(); ++r) {
    const Ring& ring = edit.parts[r];
    for (std::size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()], r, i});
  }
  return edges;
}

bool Contains(const Edge& edge, const Vector2d& p) { return DistanceToSegment(p, edge.begin, edge.end) < 1e-9; }

std::optional<Vector2d> CrossingOf(const Edge& a, const Edge& b, bool neighbours) {
  if (!neighbours) {
    for (const Vector2d& p : {b.begin, b.end}) {
      if (Contains(a, p)) return p;
    }
    for (const Vector2d& p : {a.begin, a.end}) {
      if (Contains(b, p)) return p;
    }
  }
  const Vector2d u = a.end - a.begin;
  const Vector2d v = b.end - b.begin;
  const double determinant = Cross(u, v);
  if (neighbours || determinant == 0) return std::nullopt;
  const double s = Cross(b.begin - a.begin, v) / determinant;
  const double t = Cross(b.begin - a.begin, u) / determinant;
  if (s < 0 || s > 1 || t < 0 || t > 1) return std::nullopt;
  return Vector2d(a.begin + s * u);
}

}  // namespace

std::size_t NumVertices(const MapEdit& edit) {
  std::size_t count = 0;
  for (const Ring& part : edit.parts) count += part.size();
  return count;
}

bool IsInside(const MapEdit& edit, const Vector2d& p) {
  bool inside = false;
  for (const Ring& ring : edit.parts) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d& a = ring[i];
      const Vector2d& b = ring[(i + 1) % ring.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
    }
  }
  return inside;
}

void ForEachCell(const MapEdit& edit, const SiteRaster& raster, const CellVisitor& visit) {
  if (edit.kind != EditKind::kCells) return VisitShape(edit, raster, visit);
  MapEdit square = edit;
  for (const Ring& ring : edit.parts) {
    square.parts = {ring};
    VisitShape(square, raster, visit);
  }
}

std::int64_t ApplyEdit(const MapEdit& edit, SiteRaster* raster) {
  const std::optional<CellState> state = StateOf(edit);
  if (!state) return 0;
  const float value = LogOddsOf(*state);
  std::int64_t changed = 0;
  ForEachCell(edit, *raster, [&](int column, int row) {
    float& cell = raster->At(column, row);
    changed += IsSame(cell, value) ? 0 : 1;
    cell = value;
  });
  return changed;
}

std::optional<Vector2d> FindSelfCrossing(const MapEdit& edit) {
  if (!IsArea(edit.kind)) return std::nullopt;
  const std::vector<Edge> edges = EdgesOf(edit);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const std::size_t size = edit.parts[edges[i].ring].size();
      const bool neighbours = edges[i].ring == edges[j].ring &&
                              (edges[j].index - edges[i].index == 1 || edges[j].index - edges[i].index == size - 1);
      if (const auto crossing = CrossingOf(edges[i], edges[j], neighbours)) return crossing;
    }
  }
  return std::nullopt;
}

CellBox BoxOf(const MapEdit& edit, double cell_size_m) {
  const Bounds bounds = BoundsOf(edit);
  const Vector2d margin = Vector2d::Constant(HalfWidth(edit, cell_size_m));
  const Vector2d low = (bounds.low - margin) / cell_size_m;
  const Vector2d high = (bounds.high + margin) / cell_size_m;
  const auto cell = [](double place) { return static_cast<std::int64_t>(std::floor(place)); };
  return {cell(low.x()), cell(low.y()), cell(high.x()) + 1, cell(high.y()) + 1};
}

double DistanceToRaster(const MapEdit& edit, const SiteRaster& raster) { return Distance(BoundsOf(edit), raster); }

double DistanceToRaster(const Eigen::Vector2d& p, const SiteRaster& raster) { return Distance({p, p}, raster); }

}  // namespace survey
