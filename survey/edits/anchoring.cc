// SPDX-License-Identifier: Apache-2.0
#include "survey/edits/anchoring.h"

#include <algorithm>
#include <cmath>

#include "survey/geometry/rigid_fit.h"
#include "survey/grid/coverage.h"

namespace survey {
namespace {

using Eigen::Vector2d;
using Ring = std::vector<Vector2d>;

constexpr double kSearch_m = 0.5;
constexpr double kWall_m = 0.15;  // so near a wall is what a person means

// Array index of the scan that drew what a person points at: the nearest wall within the width of a hand, else the
// nearest cell; empty when no scan drew anything within kSearch_m.
std::optional<std::size_t> WitnessNear(const Vector2d& place, const SiteRaster& grid) {
  const auto centre = grid.CellOf(place);
  const auto reach = static_cast<std::int64_t>(std::ceil(kSearch_m / grid.cell_size_m));
  std::optional<std::size_t> witness;
  double least = kSearch_m + kWall_m;
  for (std::int64_t row = centre.y() - reach; row <= centre.y() + reach; ++row) {
    for (std::int64_t column = centre.x() - reach; column <= centre.x() + reach; ++column) {
      if (!grid.Contains(column, row)) continue;
      const int c = static_cast<int>(column);
      const int r = static_cast<int>(row);
      const float scan = grid.drawn_by[grid.Index(c, r)];
      const bool same = column == centre.x() && row == centre.y();
      const double distance = same ? 0.0 : (grid.CentreOf(c, r) - place).norm();
      const double cost = distance + (grid.At(c, r) > 0.0F ? 0.0 : kWall_m);
      if (std::isnan(scan) || distance > kSearch_m || cost >= least) continue;
      least = cost;
      witness = static_cast<std::size_t>(scan);
    }
  }
  return witness;
}

Vector2d CentreOf(const Ring& ring) {
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& p : ring) sum += p;
  return sum / static_cast<double>(ring.size());
}

const Pose2* FindPose(StampNs stamp_ns, const BlockPoses& poses) {
  const auto found = std::lower_bound(poses.stamps.begin(), poses.stamps.end(), stamp_ns);
  if (found == poses.stamps.end() || *found != stamp_ns) return nullptr;
  return &poses.site_from_scan[static_cast<std::size_t>(found - poses.stamps.begin())];
}

Ring VerticesOf(const MapEdit& edit) {
  Ring vertices;
  for (const Ring& part : edit.parts) vertices.insert(vertices.end(), part.begin(), part.end());
  return vertices;
}

// Shift of a vertex that hangs on nothing: the others' shifts, weighted by the inverse of their distance.
Vector2d BlendedShift(const Vector2d& place, const Ring& held, const Ring& shifts) {
  constexpr double kNear_m = 0.01;
  Vector2d sum = Vector2d::Zero();
  double weights = 0.0;
  for (std::size_t i = 0; i < held.size(); ++i) {
    const double weight = 1.0 / std::max(kNear_m, (held[i] - place).norm());
    sum += weight * shifts[i];
    weights += weight;
  }
  return sum / weights;
}

// Twice the area, with the sign of the way round.
double Area2(const Ring& ring) {
  double sum = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d a = ring[i] - ring[0];
    const Vector2d b = ring[(i + 1) % ring.size()] - ring[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

double AreaChange(const MapEdit& before, const MapEdit& after) {
  if (!IsArea(before.kind)) return 0.0;
  double old_area = 0.0;
  double new_area = 0.0;
  for (std::size_t i = 0; i < before.parts.size(); ++i) {
    old_area += std::abs(Area2(before.parts[i]));
    new_area += std::abs(Area2(after.parts[i]));
  }
  return old_area > 0.0 ? new_area / old_area - 1.0 : 0.0;
}

// The largest residual of a rigid fit of the old vertices on the new ones.
double Residual(const Ring& before, const Ring& after) {
  const std::optional<RigidFit> fit = FitRigid(before, after);
  if (!fit) return 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i)
    largest = std::max(largest, (fit->target_from_source * before[i] - after[i]).norm());
  return largest;
}

void PutVertices(const Ring& vertices, MapEdit* edit) {
  std::size_t next = 0;
  for (Ring& part : edit->parts) {
    for (Vector2d& p : part) p = vertices[next++];
  }
}

}  // namespace

MapEdit Densified(const MapEdit& edit, double spacing_m) {
  if (edit.kind == EditKind::kCells || edit.kind == EditKind::kAdjust) return edit;
  MapEdit dense = edit;
  for (Ring& part : dense.parts) {
    const Ring drawn = std::move(part);
    part.clear();
    const std::size_t segments = IsArea(edit.kind) ? drawn.size() : drawn.size() - 1;
    for (std::size_t i = 0; i < segments; ++i) {
      const Vector2d along = drawn[(i + 1) % drawn.size()] - drawn[i];
      const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / spacing_m - 1e-6)));
      for (int k = 0; k < pieces; ++k) part.push_back(drawn[i] + along * k / pieces);
    }
    if (!IsArea(edit.kind)) part.push_back(drawn.back());
  }
  return dense;
}

SiteRaster PartAround(const MapEdit& edit, const SiteRaster& map) {
  const auto reach = static_cast<std::int64_t>(std::ceil(kSearch_m / map.cell_size_m));
  return PartOf(StripsOf(map), BoxOf(edit, map.cell_size_m), reach);
}

std::vector<std::optional<EditAnchor>> AnchorsOf(const MapEdit& edit, const SiteRaster& grid, const BlockPoses& poses) {
  std::vector<std::optional<EditAnchor>> anchors;
  for (const Ring& part : edit.parts) {
    for (const Vector2d& p : part) {
      anchors.emplace_back();
      if (edit.kind == EditKind::kAdjust && &p != &part.front()) continue;
      const auto witness = WitnessNear(edit.kind == EditKind::kCells ? CentreOf(part) : p, grid);
      if (witness) anchors.back() = {poses.stamps[*witness], Inverse(poses.site_from_scan[*witness]) * p};
    }
  }
  return anchors;
}

AppliedEdit MovedWithScans(const MapEdit& edit, const std::vector<std::optional<EditAnchor>>& anchors,
                           const BlockPoses& poses) {
  AppliedEdit moved{.edit = edit, .vertices = static_cast<int>(NumVertices(edit))};
  const Ring drawn = VerticesOf(edit);
  Ring vertices = drawn;
  Ring held;
  Ring shifts;
  std::vector<bool> is_held(drawn.size(), false);
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    if (!anchors[i]) continue;
    const Pose2* pose = FindPose(anchors[i]->stamp_ns, poses);
    if (pose == nullptr) {
      ++moved.lost;
      continue;
    }
    vertices[i] = *pose * anchors[i]->p_in_scan;
    held.push_back(drawn[i]);
    shifts.push_back(vertices[i] - drawn[i]);
    moved.shift_m = std::max(moved.shift_m, shifts.back().norm());
    is_held[i] = true;
  }
  moved.anchored = static_cast<int>(held.size());
  if (held.empty()) return moved;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (!is_held[i] && edit.kind != EditKind::kAdjust) vertices[i] += BlendedShift(drawn[i], held, shifts);
  }
  moved.drawn = edit.parts;
  PutVertices(vertices, &moved.edit);
  moved.area_change = AreaChange(edit, moved.edit);
  if (edit.kind != EditKind::kCells && edit.kind != EditKind::kAdjust) moved.residual_m = Residual(drawn, vertices);
  return moved;
}

}  // namespace survey
