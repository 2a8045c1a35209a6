// SPDX-License-Identifier: Apache-2.0
#include "survey/matching/surface_map.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <numeric>

namespace survey {
namespace {

constexpr float kNormalReach_m = 0.3F;        // neighbours along the scan that count for a normal
constexpr float kMaxGap_m = 0.3F;             // neighbours farther apart than this ...
constexpr float kMaxGapPerRange = 0.1F;       // ... and this part of the range lie on different surfaces
constexpr float kSharpBeamSpacing_m = 0.03F;  // single points of wider beams weigh less
constexpr float kMaxRoughness_m = 0.03F;      // rms distance from the line
constexpr float kMaxAspect = 0.25F;           // rms across by rms along

// Of the nine cells around a middle one, which is the fifth, row by row from the south-west: where they lie.
constexpr int kMiddle = 4;
constexpr std::array<int, 9> kRightOf = {-1, 0, 1, -1, 0, 1, -1, 0, 1};
constexpr std::array<int, 9> kUpOf = {-1, -1, -1, 0, 0, 0, 1, 1, 1};

// Sums over points, for the line through them.
struct Moments {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  Moments Plus(double px, double py) const {
    return {n + 1.0, x + px, y + py, xx + px * px, xy + px * py, yy + py * py};
  }
  Moments Minus(const Moments& other) const {
    return {n - other.n, x - other.x, y - other.y, xx - other.xx, xy - other.xy, yy - other.yy};
  }
};

// Unit normal of the line through the points, or zero when they are no line.
Eigen::Vector2f NormalOf(const Moments& m) {
  if (m.n < 3.0) return Eigen::Vector2f::Zero();
  const double mean_x = m.x / m.n;
  const double mean_y = m.y / m.n;
  const auto xx = static_cast<float>(m.xx / m.n - mean_x * mean_x);
  const auto xy = static_cast<float>(m.xy / m.n - mean_x * mean_y);
  const auto yy = static_cast<float>(m.yy / m.n - mean_y * mean_y);
  const float half_trace = 0.5F * (xx + yy);
  const float half_difference = 0.5F * (xx - yy);
  const float root = std::sqrt(half_difference * half_difference + xy * xy);
  const float across = std::max(half_trace - root, 0.0F);
  const float along = half_trace + root;
  if (across > kMaxRoughness_m * kMaxRoughness_m || across > kMaxAspect * kMaxAspect * along)
    return Eigen::Vector2f::Zero();
  // Eigenvector of the larger value is (root + half_difference, xy) or (xy, root - half_difference).
  const Eigen::Vector2f direction = half_difference >= 0.0F ? Eigen::Vector2f(root + half_difference, xy)
                                                            : Eigen::Vector2f(xy, root - half_difference);
  return Eigen::Vector2f(-direction.y(), direction.x()).normalized();
}

// Weight of a single point where neighbouring beams that hit are so far apart: it may lie anywhere between them.
float SharpnessOf(float beam_spacing) {
  const float blur = std::max(1.0F, beam_spacing / kSharpBeamSpacing_m);
  return 1.0F / (blur * blur);
}

// Distance across the beam to the neighbouring beam that hit: how well a single point is placed.
float BeamSpacing(std::span<const Eigen::Vector2f> hits, std::size_t i) {
  float spacing = std::numeric_limits<float>::max();
  for (const std::size_t j : {i - 1, i + 1}) {
    if (j >= hits.size()) continue;
    const float cross = hits[i].x() * hits[j].y() - hits[i].y() * hits[j].x();
    spacing = std::min(spacing, std::abs(cross) / hits[j].norm());
  }
  return spacing;
}

// Normals of the surface at hits, asked in the order of the scan: of the line through the neighbours of the same
// surface that are in reach, but two on each side if there are.
class NormalsAlongScan {
 public:
  explicit NormalsAlongScan(std::span<const Eigen::Vector2f> hits)
      : hits_(hits), up_to_(hits.size() + 1), surface_(hits.size()) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      up_to_[i + 1] = up_to_[i].Plus(static_cast<double>(hits[i].x()), static_cast<double>(hits[i].y()));
      if (i > 0) surface_[i] = surface_[i - 1] + (GapBefore(i) ? 1 : 0);
    }
  }

  // Pointing to the lidar; zero where there is no line.
  Eigen::Vector2f At(std::size_t i) {
    while (surface_[first_] != surface_[i] || (first_ + 2 < i && !InReach(first_, i))) ++first_;
    last_ = std::max(last_, i);
    while (last_ > i + 2 && !InReach(last_, i)) --last_;
    while (last_ + 1 < hits_.size() && surface_[last_ + 1] == surface_[i] && (last_ < i + 2 || InReach(last_ + 1, i)))
      ++last_;
    const Eigen::Vector2f normal = NormalOf(up_to_[last_ + 1].Minus(up_to_[first_]));
    return normal.dot(hits_[i]) > 0.0F ? Eigen::Vector2f(-normal) : normal;
  }

 private:
  // Whether hit i lies on another surface than the one before.
  bool GapBefore(std::size_t i) const {
    const float square = (hits_[i] - hits_[i - 1]).squaredNorm();
    if (square <= kMaxGap_m * kMaxGap_m) return false;
    const float max_gap = kMaxGap_m + kMaxGapPerRange * hits_[i].norm();
    return square > max_gap * max_gap;
  }
  bool InReach(std::size_t i, std::size_t j) const {
    return (hits_[i] - hits_[j]).squaredNorm() <= kNormalReach_m * kNormalReach_m;
  }

  std::span<const Eigen::Vector2f> hits_;
  std::vector<Moments> up_to_;  // of the hits before
  std::vector<int> surface_;    // by hit
  std::size_t first_ = 0;       // neighbours of the last hit asked for
  std::size_t last_ = 0;
};

// Leaves of the hits, numbered by `kept` in their order, those that lie at least the spacing from the last one left.
void ThinOut(std::span<const Eigen::Vector2f> hits, float spacing, std::vector<std::size_t>* kept) {
  std::size_t count = 0;
  for (const std::size_t i : *kept) {
    if (count == 0 || (hits[i] - hits[(*kept)[count - 1]]).squaredNorm() >= spacing * spacing) (*kept)[count++] = i;
  }
  kept->resize(count);
}

}  // namespace

void SurfacePointsOfScan(std::span<const Eigen::Vector2f> hits, double spacing_m, std::size_t max_points,
                         std::vector<SurfacePoint>* points) {
  std::vector<std::size_t> kept(hits.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  auto spacing = static_cast<float>(spacing_m);
  ThinOut(hits, spacing, &kept);
  // More neighbours than these would not tell more of a surface.
  std::vector<Eigen::Vector2f> neighbours;
  neighbours.reserve(kept.size());
  for (const std::size_t i : kept) neighbours.push_back(hits[i]);
  std::vector<std::size_t> chosen(kept.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  while (max_points != 0 && chosen.size() > max_points) {
    spacing *= 1.4142135F;
    ThinOut(neighbours, spacing, &chosen);
  }
  points->clear();
  NormalsAlongScan normals(neighbours);
  for (const std::size_t i : chosen) {
    const Eigen::Vector2f normal = normals.At(i);
    points->push_back({neighbours[i], normal, normal.isZero() ? SharpnessOf(BeamSpacing(hits, kept[i])) : 1.0F});
  }
}

SurfaceMap::SurfaceMap(double cell_size_m)
    : cell_size_m_(cell_size_m), cells_per_m_(static_cast<float>(1.0 / cell_size_m)) {}

void SurfaceMap::Insert(const Pose2& map_from_scan, std::span<const SurfacePoint> points_in_scan) {
  if (points_in_scan.empty()) return;
  const Eigen::Matrix2f rotation = Rotation2(map_from_scan.theta).cast<float>();
  const Eigen::Vector2f translation = map_from_scan.Translation().cast<float>();
  std::vector<SurfacePoint> moved;
  moved.reserve(points_in_scan.size());
  Eigen::Vector2f low = translation;
  Eigen::Vector2f high = translation;
  for (const SurfacePoint& point : points_in_scan) {
    moved.push_back({rotation * point.position + translation, rotation * point.normal, point.weight});
    low = low.cwiseMin(moved.back().position);
    high = high.cwiseMax(moved.back().position);
  }
  GrowToHold(low, high);
  for (const SurfacePoint& point : moved) Enter(point.position, point.normal);
}

SurfaceTile& SurfaceMap::OwnTile(int column, int row) {
  std::shared_ptr<SurfaceTile>& tile =
      tiles_[IndexOf((column >> SurfaceTile::kBits) - min_x_, (row >> SurfaceTile::kBits) - min_y_)];
  if (tile == nullptr) {
    tile = std::make_shared<SurfaceTile>();
  } else if (tile.use_count() > 1) {
    tile = std::make_shared<SurfaceTile>(*tile);
  } else {
    // The last other owner may have let go in another thread: see all that it did.
    std::atomic_thread_fence(std::memory_order_acquire);
  }
  return *tile;
}

void SurfaceMap::TellAround(int column, int row) {
  for (int place = 0; place < 9; ++place) {
    const int c = column - (place % 3 - 1);
    const int r = row - (place / 3 - 1);
    OwnTile(c, r).cells[SurfaceTile::CellOf(c, r)] |= std::uint32_t{1} << (SurfaceTile::kAround + place);
  }
}

void SurfaceMap::Enter(const Eigen::Vector2f& p, const Eigen::Vector2f& normal) {
  const int column = static_cast<int>(std::floor(p.x() * cells_per_m_));
  const int row = static_cast<int>(std::floor(p.y() * cells_per_m_));
  SurfaceTile& tile = OwnTile(column, row);
  std::uint32_t& cell = tile.cells[SurfaceTile::CellOf(column, row)];
  std::uint32_t last = 0;
  for (std::uint32_t i = cell & SurfaceTile::kIndex; i != 0; i = tile.surfels[i].next) {
    Surfel& surfel = tile.surfels[i];
    if (surfel.normal_sum.dot(normal) >= 0.0F) {
      surfel.count += 1.0F;
      surfel.mean += (p - surfel.mean) / surfel.count;
      surfel.normal_sum += normal;
      const float length = surfel.normal_sum.norm();
      surfel.normal = length > 0.5F * surfel.count ? Eigen::Vector2f(surfel.normal_sum / length)
                                                   : Eigen::Vector2f(Eigen::Vector2f::Zero());
      return;
    }
    last = i;
  }
  const auto added = static_cast<std::uint32_t>(tile.surfels.size());
  tile.surfels.push_back({.mean = p, .normal_sum = normal, .normal = normal, .count = 1.0F, .next = 0});
  if (last != 0) {
    tile.surfels[last].next = added;
    return;
  }
  cell |= added;
  TellAround(column, row);
}

const Surfel* SurfaceMap::Nearest(const Eigen::Vector2f& p, const Eigen::Vector2f& normal) const {
  const float x = p.x() * cells_per_m_;
  const float y = p.y() * cells_per_m_;
  const float left = std::floor(x);
  const float bottom = std::floor(y);
  const int column = static_cast<int>(left);
  const int row = static_cast<int>(bottom);
  const SurfaceTile* centre = TileAt(column, row);
  if (centre == nullptr) return nullptr;
  const std::size_t middle = SurfaceTile::CellOf(column, row);
  std::uint32_t around = centre->cells[middle] >> SurfaceTile::kAround;
  if (around == 0) return nullptr;
  const Surfel* nearest = nullptr;
  float nearest_square = std::numeric_limits<float>::max();
  const auto visit = [&](const SurfaceTile& tile, std::size_t cell) {
    for (std::uint32_t i = tile.cells[cell] & SurfaceTile::kIndex; i != 0; i = tile.surfels[i].next) {
      const Surfel& surfel = tile.surfels[i];
      if (surfel.normal.dot(normal) < 0.0F) continue;
      const float square = (surfel.mean - p).squaredNorm();
      if (square >= nearest_square) continue;
      nearest_square = square;
      nearest = &surfel;
    }
  };
  // The cell itself first: what it holds is mostly nearer than what the others can hold.
  if ((around & (1U << kMiddle)) != 0) visit(*centre, middle);
  around &= ~(1U << kMiddle);
  const auto gap_square = [cell = static_cast<float>(cell_size_m_)](float cells) {
    return cells * cells * cell * cell;
  };
  const std::array<float, 3> beside = {gap_square(x - left), 0.0F, gap_square(left + 1.0F - x)};
  const std::array<float, 3> above = {gap_square(y - bottom), 0.0F, gap_square(bottom + 1.0F - y)};
  constexpr unsigned kInner = SurfaceTile::kCells - 2;
  const auto inner = [](int i) { return static_cast<unsigned>((i & (SurfaceTile::kCells - 1)) - 1) < kInner; };
  const bool one_tile = inner(column) && inner(row);
  for (; around != 0; around &= around - 1) {
    const auto place = static_cast<std::size_t>(std::countr_zero(around));
    const int right = kRightOf[place];
    const int up = kUpOf[place];
    if (beside[static_cast<std::size_t>(right + 1)] + above[static_cast<std::size_t>(up + 1)] >= nearest_square)
      continue;
    if (one_tile) {
      visit(*centre, middle + static_cast<std::size_t>(up * SurfaceTile::kCells + right));
    } else {
      visit(*TileAt(column + right, row + up), SurfaceTile::CellOf(column + right, row + up));
    }
  }
  return nearest;
}

void SurfaceMap::GrowToHold(const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
  // One cell more than the points need: their neighbours are marked.
  const auto tile_of = [&](float p, int margin) {
    return (static_cast<int>(std::floor(p * cells_per_m_)) + margin) >> SurfaceTile::kBits;
  };
  const bool empty = width_ == 0;
  const int min_x = empty ? tile_of(low.x(), -1) : std::min(min_x_, tile_of(low.x(), -1));
  const int min_y = empty ? tile_of(low.y(), -1) : std::min(min_y_, tile_of(low.y(), -1));
  const int end_x = std::max(empty ? min_x : min_x_ + width_, tile_of(high.x(), 1) + 1);
  const int end_y = std::max(empty ? min_y : min_y_ + height_, tile_of(high.y(), 1) + 1);
  if (min_x == min_x_ && min_y == min_y_ && end_x == min_x_ + width_ && end_y == min_y_ + height_) return;
  const int width = end_x - min_x;
  std::vector<std::shared_ptr<SurfaceTile>> tiles(static_cast<std::size_t>(width) *
                                                  static_cast<std::size_t>(end_y - min_y));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x)
      tiles[static_cast<std::size_t>(y + min_y_ - min_y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x + min_x_ - min_x)] = std::move(tiles_[IndexOf(x, y)]);
  }
  tiles_ = std::move(tiles);
  min_x_ = min_x;
  min_y_ = min_y;
  width_ = width;
  height_ = end_y - min_y;
}

}  // namespace survey
