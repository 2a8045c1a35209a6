// SPDX-License-Identifier: Apache-2.0
#include "survey/features/face_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace survey {
namespace {

using Eigen::Vector2d;

// Distances here are in cells, from the face, positive on the free side.
constexpr double kReach = 3.5;  // of the tables
constexpr int kPerCell = 16;
constexpr int kEntries = static_cast<int>(2 * kReach * kPerCell) + 1;
constexpr double kFront = 2.5;   // cells looked at in front of the face ...
constexpr double kBehind = 2.2;  // ... and behind it: not yet the other face of a thin wall

constexpr std::array<double, 5> kNoise = {0.2, 0.28, 0.4, 0.55, 0.8};  // sigma of the hits across the face
constexpr std::array<double, 3> kScans = {30, 100, 300};               // that saw a cell of the face
constexpr std::array<double, 3> kBeams = {0.6, 1.5, 4.0};              // of a scan that end on a cell's width of face
constexpr double kAcross = 2.0;  // as many pass a cell in front of it: oblique ones pass on to the cells beside
constexpr double kOther = 0.02;  // chance of a state that the model does not explain: persons, edges, glass

// Evidence of one hit and one miss, and where it is clamped (log-odds, p = 0.6, 0.45, 0.12, 0.97): the states hardly
// depend on them.
constexpr double kHit = 0.405;
constexpr double kMiss = -0.201;
constexpr double kLowest = -1.99;
constexpr double kHighest = 3.48;
constexpr double kClearlyFree = -1.2;
constexpr double kClearlyWall = 1.3;

CellState StateOf(float log_odds) {
  if (std::isnan(log_odds)) return CellState::kUnknown;
  if (static_cast<double>(log_odds) < kClearlyFree) return CellState::kFree;
  return static_cast<double>(log_odds) < kClearlyWall ? CellState::kOpen : CellState::kWall;
}

using StateChances = std::array<double, 4>;

// Share of the evidence below a limit once it has come to rest between the clamps: a random walk with drift.
double ShareBelow(double limit, double drift, double variance) {
  const double rate = 2 * drift / variance;
  if (std::abs(rate) < 1e-6) return (limit - kLowest) / (kHighest - kLowest);
  const double top = std::exp(rate * (kLowest - kHighest));
  return rate > 0 ? (std::exp(rate * (limit - kHighest)) - top) / (1 - top)
                  : (1 - std::exp(rate * (limit - kLowest))) / (1 - 1 / top);
}

// hit, passed: of the rays that end on a cell's width of face, the share that ends in the cell and that passes it.
StateChances ChancesOf(double hit, double passed, double scans, double beams) {
  const double p_hit = 1 - std::exp(-beams * hit);
  const double p_miss = (1 - p_hit) * (1 - std::exp(-kAcross * beams * passed));
  const double updates = scans * (p_hit + p_miss);
  const double none = std::exp(-updates);
  const double few = none * (updates + updates * updates / 2 + updates * updates * updates / 6);
  const double many = std::max(0.0, 1 - none - few);
  const double drift = kHit * p_hit + kMiss * p_miss;
  const double variance = std::max(kHit * kHit * p_hit + kMiss * kMiss * p_miss, 1e-300);
  const double free = ShareBelow(kClearlyFree, drift, variance);
  const double wall = 1 - ShareBelow(kClearlyWall, drift, variance);
  StateChances chances = {none, many * free, few + many * (1 - free - wall), many * wall};
  for (double& chance : chances) chance = (1 - kOther) * chance + kOther / 4;
  return chances;
}

// Share of a face's length, in cells, that runs through a cell whose centre is `distance` from it: 1 for a face along
// the cells, a trapezoid for a tilted one.
class Crossing {
 public:
  explicit Crossing(const Vector2d& normal)
      : base_(normal.cwiseAbs().sum() / 2), top_(std::abs(std::abs(normal.x()) - std::abs(normal.y())) / 2) {}

  double At(double distance) const {
    const double d = std::abs(distance);
    const double height = 1 / (base_ + top_);
    if (d <= top_) return height;
    return d >= base_ ? 0.0 : height * (base_ - d) / (base_ - top_);
  }
  double base() const { return base_; }

 private:
  double base_;
  double top_;
};

// Logarithms of the chances of all states, by distance from the face.
class StateTable {
 public:
  StateTable(const Crossing& crossing, double noise, double scans, double beams) {
    constexpr int kSteps = 24;
    for (int i = 0; i < kEntries; ++i) {
      const double distance = static_cast<double>(i) / kPerCell - kReach;
      double hit = 0.0;
      const double step = 2 * crossing.base() / kSteps;
      for (int k = 0; k < kSteps; ++k) {
        const double from_centre = -crossing.base() + (k + 0.5) * step;
        hit += step * crossing.At(from_centre) * std::exp(-0.5 * std::pow((distance + from_centre) / noise, 2));
      }
      hit /= noise * std::sqrt(2 * std::numbers::pi);
      const double not_before = 0.5 * std::erfc(-distance / (noise * std::numbers::sqrt2));
      const StateChances chances = ChancesOf(std::min(hit, 1.0), std::max(0.0, not_before - hit / 2), scans, beams);
      for (std::size_t s = 0; s < chances.size(); ++s) {
        log_chances_[static_cast<std::size_t>(i)][s] = static_cast<float>(std::log(chances[s]));
      }
    }
  }

  float At(double distance, CellState state) const {
    const int i = static_cast<int>(std::lround((distance + kReach) * kPerCell));
    return log_chances_[static_cast<std::size_t>(std::clamp(i, 0, kEntries - 1))][static_cast<std::size_t>(state)];
  }

 private:
  std::array<std::array<float, 4>, kEntries> log_chances_;
};

// A cell of the stretch: distance from the assumed face, place along it from its middle, in cells.
struct BandCell {
  double distance;
  double along;
  CellState state;
};

std::vector<BandCell> BandCells(std::span<const ObservedCell> cells, const FaceStretch& about, double cell_size_m) {
  const Vector2d along(-about.normal.y(), about.normal.x());
  std::vector<BandCell> band;
  for (const ObservedCell& cell : cells) {
    const double distance = (about.normal.dot(cell.p) - about.offset) / cell_size_m;
    const double place = along.dot(cell.p);
    if (place < about.from || place > about.to || distance > kFront || distance < -kBehind) continue;
    band.push_back({distance, (place - (about.from + about.to) / 2) / cell_size_m, cell.state});
  }
  return band;
}

struct Hypothesis {
  double offset = 0.0;  // cells
  double slope = 0.0;   // of the offset along the face
  double log_chance = 0.0;
};

// Cells side by side share their phase and the errors of the scans: a face tells no more than so many of its columns.
constexpr double kIndependentColumns = 8.0;

std::vector<Hypothesis> Judge(const std::vector<BandCell>& band, const Vector2d& normal, double length) {
  std::vector<StateTable> tables;
  const Crossing crossing(normal);
  for (const double noise : kNoise) {
    for (const double scans : kScans) {
      for (const double beams : kBeams) tables.emplace_back(crossing, noise, scans, beams);
    }
  }
  const double weight = std::min(1.0, kIndependentColumns / std::max(length, 1.0));
  std::vector<Hypothesis> all;
  for (int turn = -4; turn <= 4; ++turn) {
    const double slope = turn * 0.25 / std::max(length / 2, 1.0);
    for (int step = -16; step <= 16; ++step) {
      const double offset = step * 0.1;
      for (const StateTable& table : tables) {
        double sum = 0.0;
        for (const BandCell& cell : band) {
          sum += static_cast<double>(table.At(cell.distance - offset - slope * cell.along, cell.state));
        }
        all.push_back({offset, slope, weight * sum});
      }
    }
  }
  return all;
}

}  // namespace

std::vector<ObservedCell> CellsNear(const SiteRaster& raster, const Vector2d& p_in_site, double radius_m) {
  std::vector<ObservedCell> cells;
  const auto middle = raster.CellOf(p_in_site);
  const std::int64_t reach = std::llround(radius_m / raster.cell_size_m) + 1;
  for (std::int64_t row = middle.y() - reach; row <= middle.y() + reach; ++row) {
    for (std::int64_t column = middle.x() - reach; column <= middle.x() + reach; ++column) {
      if (!raster.Contains(column, row)) continue;
      const Vector2d p = raster.CentreOf(static_cast<int>(column), static_cast<int>(row)) - p_in_site;
      if (p.norm() > radius_m) continue;
      cells.push_back({p, StateOf(raster.At(static_cast<int>(column), static_cast<int>(row)))});
    }
  }
  return cells;
}

FacePlace PlaceFace(std::span<const ObservedCell> cells, const FaceStretch& about, double cell_size_m) {
  const double length = (about.to - about.from) / cell_size_m;
  const std::vector<Hypothesis> all = Judge(BandCells(cells, about, cell_size_m), about.normal, length);
  const double best = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
                        return a.log_chance < b.log_chance;
                      })->log_chance;
  double sum = 0.0;
  Vector2d mean = Vector2d::Zero();
  Vector2d squares = Vector2d::Zero();
  for (const Hypothesis& one : all) {
    const double chance = std::exp(one.log_chance - best);
    const Vector2d value(one.offset, one.slope);
    sum += chance;
    mean += chance * value;
    squares += chance * value.cwiseAbs2();
  }
  mean /= sum;
  const Vector2d variance = squares / sum - mean.cwiseAbs2();
  const Vector2d along(-about.normal.y(), about.normal.x());
  const double middle = (about.from + about.to) / 2;
  FacePlace place;
  // The stretch turns about its own middle.
  place.normal = (about.normal - mean.y() * along).normalized();
  place.offset = place.normal.dot((about.offset + mean.x() * cell_size_m) * about.normal + middle * along);
  place.sigma_offset = cell_size_m * std::sqrt(std::max(variance.x(), 0.0) + 0.05 * 0.05);
  place.sigma_angle = std::sqrt(std::max(variance.y(), 0.0) + std::pow(0.05 / std::max(length / 2, 1.0), 2));
  return place;
}

}  // namespace survey
