// SPDX-License-Identifier: Apache-2.0
#include "survey/cloud/checkerboard_targets.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace survey {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Box = std::array<int, 3>;
using Parameters = Eigen::Matrix<double, 5, 1>;  // centre x, y (m), direction (rad), mean, half the contrast

constexpr double kEdge = 0.03;         // width of the change of shades, of the board's size
constexpr double kReach = 0.45;        // of the points about the centre, of the board's size
constexpr double kTwoShades = 0.7;     // share of the variance that two shades explain
constexpr double kLeastShade = 0.2;    // of the points, in either shade
constexpr double kLeastPattern = 0.7;  // agreement with four squares, 1 is perfect
constexpr double kLeastSquare = 0.1;   // of the points, in each square

struct ShadedPoint {
  Vector3d p;
  double intensity = 0.0;
};

using Boxes = std::map<Box, std::vector<ShadedPoint>>;

Boxes IntoBoxes(std::span<const Eigen::Vector3f> cloud, std::span<const float> intensities, double size) {
  Boxes boxes;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (std::isnan(intensities[i])) continue;
    const Vector3d p = cloud[i].cast<double>();
    const Eigen::Vector3i box = (p / size).array().floor().cast<int>();
    boxes[{box.x(), box.y(), box.z()}].push_back({p, static_cast<double>(intensities[i])});
  }
  return boxes;
}

std::vector<ShadedPoint> Around(const Boxes& boxes, const Vector3d& centre, double size, double reach) {
  std::vector<ShadedPoint> points;
  const Eigen::Vector3i low = ((centre.array() - reach) / size).floor().cast<int>();
  const Eigen::Vector3i high = ((centre.array() + reach) / size).floor().cast<int>();
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const auto box = boxes.find({x, y, z});
        if (box == boxes.end()) continue;
        for (const ShadedPoint& point : box->second) {
          if ((point.p - centre).norm() <= reach) points.push_back(point);
        }
      }
    }
  }
  return points;
}

// The intensity between two shades [Otsu79]; empty where there are not two.
std::optional<double> BetweenShades(const std::vector<ShadedPoint>& points) {
  std::vector<double> sorted;
  for (const ShadedPoint& point : points) sorted.push_back(point.intensity);
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : sorted) {
    sum += value;
    squares += value * value;
  }
  const double variance = squares / n - std::pow(sum / n, 2);
  double below = 0.0, best = 0.0;
  std::optional<double> threshold;
  for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
    below += sorted[i];
    const double share = static_cast<double>(i + 1) / n;
    if (share < kLeastShade || share > 1.0 - kLeastShade) continue;
    const double difference = below / (share * n) - (sum - below) / ((1.0 - share) * n);
    const double between = share * (1.0 - share) * difference * difference;
    if (between <= best || between < kTwoShades * variance) continue;
    best = between;
    threshold = (sorted[i] + sorted[i + 1]) / 2.0;
  }
  return threshold;
}

// A plane through points, and they in it.
struct Plane {
  Vector3d origin, u, v;
  double rms_m = 0.0;

  Vector2d In(const Vector3d& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
  Vector3d Out(const Vector2d& p) const { return origin + p.x() * u + p.y() * v; }
};

Plane PlaneThrough(const std::vector<ShadedPoint>& points) {
  Plane plane;
  plane.origin.setZero();
  for (const ShadedPoint& point : points) plane.origin += point.p / static_cast<double>(points.size());
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const ShadedPoint& point : points)
    moments += (point.p - plane.origin) * (point.p - plane.origin).transpose() / static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  plane.u = solver.eigenvectors().col(2);
  plane.v = solver.eigenvectors().col(1);
  plane.rms_m = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
  return plane;
}

// Agreement of the shades with four squares about a centre: -1 or 1 when perfect.
double Pattern(const std::vector<ShadedPoint>& points, const Plane& plane, double threshold, const Vector2d& centre,
               double direction, double reach) {
  const Vector2d x_axis(std::cos(direction), std::sin(direction));
  double sum = 0.0;
  int count = 0;
  for (const ShadedPoint& point : points) {
    const Vector2d d = plane.In(point.p) - centre;
    if (d.norm() > reach) continue;
    const double x = x_axis.dot(d), y = x_axis.x() * d.y() - x_axis.y() * d.x();
    sum += ((x > 0.0) == (y > 0.0) ? 1.0 : -1.0) * (point.intensity > threshold ? 1.0 : -1.0);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

// The best of a raster of centres and directions; empty where none looks like a board.
std::optional<Parameters> Guess(const std::vector<ShadedPoint>& points, const Plane& plane, double threshold,
                                double size) {
  constexpr int kSteps = 5;
  constexpr int kDirections = 6;
  double best = kLeastPattern;
  std::optional<Parameters> guess;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      for (int k = 0; k < kDirections; ++k) {
        const Vector2d centre(0.5 * size * i / kSteps, 0.5 * size * j / kSteps);
        const double direction = 0.5 * std::numbers::pi * k / kDirections;
        const double pattern = Pattern(points, plane, threshold, centre, direction, kReach * size);
        if (std::abs(pattern) <= best) continue;
        best = std::abs(pattern);
        guess = Parameters(centre.x(), centre.y(), direction, threshold, std::copysign(1.0, pattern));
      }
    }
  }
  return guess;
}

// Gauss-Newton on the intensities of the points in reach; the contrast starts from their spread.
std::optional<BoardTarget> Fit(const std::vector<ShadedPoint>& points, const Plane& plane, Parameters parameters,
                               const BoardSearchOptions& options) {
  constexpr int kIterations = 15;
  const double width = kEdge * options.size_m;
  BoardTarget target;
  std::array<int, 4> squares{};
  double spread = 0.0;
  for (const ShadedPoint& point : points)
    spread += std::abs(point.intensity - parameters[3]) / static_cast<double>(points.size());
  parameters[4] *= spread;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Parameters right = Parameters::Zero();
    double sum = 0.0;
    target.num_points = 0;
    squares.fill(0);
    const double c = std::cos(parameters[2]), s = std::sin(parameters[2]);
    for (const ShadedPoint& point : points) {
      const Vector2d d = plane.In(point.p) - parameters.head<2>();
      if (d.norm() > kReach * options.size_m) continue;
      const double x = c * d.x() + s * d.y(), y = c * d.y() - s * d.x();
      const double tx = std::tanh(x / width), ty = std::tanh(y / width);
      const double by_x = parameters[4] * (1 - tx * tx) * ty / width, by_y = parameters[4] * tx * (1 - ty * ty) / width;
      Parameters row(-c * by_x + s * by_y, -s * by_x - c * by_y, y * by_x - x * by_y, 1.0, tx * ty);
      const double residual = point.intensity - parameters[3] - parameters[4] * tx * ty;
      normal += row * row.transpose();
      right += row * residual;
      sum += residual * residual;
      ++target.num_points;
      ++squares[static_cast<std::size_t>((x > 0.0 ? 1 : 0) + (y > 0.0 ? 2 : 0))];
    }
    if (target.num_points < options.min_points) return std::nullopt;
    target.rms_share = std::sqrt(sum / target.num_points) / std::abs(parameters[4]);
    const Parameters step = normal.ldlt().solve(right);
    if (!step.allFinite()) return std::nullopt;
    parameters += step;
  }
  const int least = *std::min_element(squares.begin(), squares.end());
  if (least < kLeastSquare * target.num_points || !(target.rms_share < options.max_rms_share)) return std::nullopt;
  target.centre = plane.Out(parameters.head<2>());
  return target;
}

std::optional<BoardTarget> Measure(const Boxes& boxes, const Vector3d& near, const BoardSearchOptions& options) {
  const double reach = kReach * options.size_m;
  const std::vector<ShadedPoint> patch = Around(boxes, near, options.size_m / 2, 2.0 * reach);
  if (static_cast<int>(patch.size()) < options.min_points) return std::nullopt;
  const std::optional<double> threshold = BetweenShades(Around(boxes, near, options.size_m / 2, reach));
  if (!threshold) return std::nullopt;
  Plane plane = PlaneThrough(Around(boxes, near, options.size_m / 2, reach));
  if (plane.rms_m > options.flatness_m) return std::nullopt;
  std::optional<Parameters> guess = Guess(patch, plane, *threshold, options.size_m);
  if (!guess) return std::nullopt;
  // The plane of the board's own points, about its centre.
  const Vector3d centre = plane.Out(guess->head<2>());
  const std::vector<ShadedPoint> board = Around(boxes, centre, options.size_m / 2, reach);
  if (static_cast<int>(board.size()) < options.min_points) return std::nullopt;
  plane = PlaneThrough(board);
  guess = Guess(board, plane, *threshold, 0.5 * options.size_m);
  if (!guess || plane.rms_m > options.flatness_m) return std::nullopt;
  return Fit(board, plane, *guess, options);
}

bool Holds(const std::vector<BoardTarget>& boards, const Vector3d& p, double size) {
  return std::any_of(boards.begin(), boards.end(),
                     [&](const BoardTarget& board) { return (board.centre - p).norm() < size; });
}

}  // namespace

std::vector<BoardTarget> FindBoards(std::span<const Eigen::Vector3f> cloud, std::span<const float> intensities,
                                    const BoardSearchOptions& options) {
  const Boxes boxes = IntoBoxes(cloud, intensities, options.size_m / 2);
  std::vector<BoardTarget> boards;
  for (const auto& [box, points] : boxes) {
    Vector3d middle = Vector3d::Zero();
    for (const ShadedPoint& point : points) middle += point.p / static_cast<double>(points.size());
    if (Holds(boards, middle, options.size_m)) continue;
    const std::optional<BoardTarget> board = Measure(boxes, middle, options);
    if (board && !Holds(boards, board->centre, options.size_m)) boards.push_back(*board);
  }
  return boards;
}

}  // namespace survey
