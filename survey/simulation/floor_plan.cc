// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/floor_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "survey/geometry/segment.h"
#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr double kCarCornerRadius = 0.35;
constexpr double kStallDepth = 5.0;

Vector2d Unit(double angle) { return {std::cos(angle), std::sin(angle)}; }
Vector2d Left(const Vector2d& v) { return {-v.y(), v.x()}; }

using Quad = std::array<Vector2d, 4>;

// Box with its centre, half sides along `forward` (unit) and to its left.
Quad Box(const Vector2d& centre, const Vector2d& forward, double half_length, double half_width) {
  const Vector2d f = half_length * forward;
  const Vector2d l = half_width * Left(forward);
  return {centre + f + l, centre - f + l, centre - f - l, centre + f - l};
}

void AddFaces(const Quad& quad, std::vector<Face>* faces) {
  for (std::size_t i = 0; i < 4; ++i) faces->push_back({quad[i], quad[(i + 1) % 4]});
}

// One box per piece, extended by half the thickness where it meets the next piece.
std::vector<Quad> BoxesOf(const Wall& wall) {
  Polyline line = wall.line;
  if (wall.closed) line.push_back(line.front());
  std::vector<Quad> boxes;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d forward = (line[i + 1] - line[i]).normalized();
    const double half = wall.thickness_m / 2;
    const Vector2d a = line[i] - (wall.closed || i > 0 ? half : 0.0) * forward;
    const Vector2d b = line[i + 1] + (wall.closed || i + 2 < line.size() ? half : 0.0) * forward;
    boxes.push_back(Box((a + b) / 2, forward, (b - a).norm() / 2, half));
  }
  return boxes;
}

// Separating axes of two boxes.
bool Overlap(const Quad& a, const Quad& b) {
  for (const Quad* quad : {&a, &b}) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Vector2d axis = (*quad)[i + 1] - (*quad)[i];
      const auto span = [&](const Quad& q) {
        double low = q[0].dot(axis);
        double high = low;
        for (const Vector2d& p : q) {
          low = std::min(low, p.dot(axis));
          high = std::max(high, p.dot(axis));
        }
        return std::pair(low, high);
      };
      const auto [low_a, high_a] = span(a);
      const auto [low_b, high_b] = span(b);
      if (high_a < low_b || high_b < low_a) return false;
    }
  }
  return true;
}

// A1, B1, ..., Z1, AA1, ..., A2: column letters as in a spreadsheet, rows from 1.
std::string GridName(int column, int row) {
  std::string name;
  if (column >= 26) name += static_cast<char>('A' + column / 26 - 1);
  name += static_cast<char>('A' + column % 26);
  return name + std::to_string(row + 1);
}

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void AddGrid(const PillarGrid& grid, std::vector<Pillar>* pillars) {
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::string name = grid.prefix + GridName(column, row);
      if (Contains(grid.without, name)) continue;
      const Vector2d centre = grid.first + Vector2d(column * grid.step.x(), row * grid.step.y());
      pillars->push_back({.name = name, .centre = centre, .size_m = grid.size_m, .round = grid.round});
    }
  }
}

Quad OutlineOf(const Car& car) { return Box(car.centre, Unit(car.heading_rad), car.length_m / 2, car.width_m / 2); }

// Each stall draws the same numbers whether or not its neighbours are taken.
void AddLineOfCars(const ParkingRow& row, const Vector2d& shift, const RandomStream& random,
                   const std::vector<Quad>& obstacles, std::vector<Car>* cars) {
  const double length = (row.to - row.from).norm();
  const Vector2d along = (row.to - row.from) / length;
  const auto num_stalls = static_cast<std::uint64_t>(std::floor(length / row.stall_width_m + 1e-6));
  for (std::uint64_t stall = 0; stall < num_stalls; ++stall) {
    const auto [taken, backwards] = random.Uniforms(4 * stall);
    if (taken >= row.occupancy) continue;
    const auto [length_part, width_part] = random.Uniforms(4 * stall + 1);
    const auto [shift_along, shift_across] = random.Normals(4 * stall + 2);
    Car car;
    car.length_m = 4.0 + 0.8 * length_part;
    car.width_m = 1.68 + 0.22 * width_part;
    const double across = std::clamp(0.15 * shift_across, -0.3, 0.3) * (kStallDepth - car.length_m);
    car.centre = row.from + shift + (static_cast<double>(stall) + 0.5) * row.stall_width_m * along +
                 std::clamp(0.06 * shift_along, -0.12, 0.12) * along + across * Left(along);
    const double crooked = std::clamp(0.015 * random.Normal(4 * stall + 3), -0.03, 0.03);
    car.heading_rad = std::atan2(along.y(), along.x()) + (backwards < 0.5 ? -0.5 : 0.5) * std::numbers::pi + crooked;
    const Quad outline = OutlineOf(car);
    if (std::none_of(obstacles.begin(), obstacles.end(), [&](const Quad& o) { return Overlap(outline, o); }))
      cars->push_back(car);
  }
}

void AddRow(const ParkingRow& row, std::uint64_t seed, const std::vector<Quad>& obstacles, std::vector<Car>* cars) {
  for (int j = 0; j < row.rows; ++j) {
    for (int i = 0; i < row.columns; ++i) {
      const std::string name = GridName(i, j);
      if (Contains(row.without, name)) continue;
      const RandomStream random(seed, static_cast<std::uint32_t>(SimulationPurpose::kParking),
                                StreamOfName(row.name + " " + name));
      AddLineOfCars(row, {i * row.step.x(), j * row.step.y()}, random, obstacles, cars);
    }
  }
}

void AddCarShapes(const Car& car, FloorPlan* plan) {
  const double radius = kCarCornerRadius;
  const Vector2d forward = Unit(car.heading_rad);
  const Quad inner = Box(car.centre, forward, car.length_m / 2 - radius, car.width_m / 2 - radius);
  for (const Vector2d& corner : inner) plan->car_discs.push_back({corner, radius});
  const std::array<Vector2d, 4> outward = {Left(forward), Vector2d(-forward), Vector2d(-Left(forward)), forward};
  for (std::size_t i = 0; i < 4; ++i)
    plan->car_faces.push_back({inner[i] + radius * outward[i], inner[(i + 1) % 4] + radius * outward[i]});
}

}  // namespace

FloorPlan BuildFloorPlan(const Scenario& scenario) {
  FloorPlan plan;
  plan.pillars = scenario.pillars;
  for (const PillarGrid& grid : scenario.pillar_grids) AddGrid(grid, &plan.pillars);

  std::vector<Quad> solids;
  for (const Wall& wall : scenario.walls) {
    for (const Quad& box : BoxesOf(wall)) {
      solids.push_back(box);
      AddFaces(box, &plan.solid_faces);
    }
  }
  for (const Pillar& pillar : plan.pillars) {
    const Quad box = Box(pillar.centre, Vector2d::UnitX(), pillar.size_m / 2, pillar.size_m / 2);
    solids.push_back(box);
    if (pillar.round) {
      plan.pillar_discs.push_back({pillar.centre, pillar.size_m / 2});
    } else {
      AddFaces(box, &plan.solid_faces);
    }
  }

  plan.cars = scenario.cars;
  for (const ParkingRow& row : scenario.parking_rows) AddRow(row, scenario.seed, solids, &plan.cars);
  for (const Car& car : plan.cars) AddCarShapes(car, &plan);
  for (const Glass& glass : scenario.glass) {
    for (std::size_t i = 0; i + 1 < glass.line.size(); ++i)
      plan.panes.push_back({glass.line[i], glass.line[i + 1], glass.response});
  }
  return plan;
}

bool IsCorner(const FloorPlan& plan, const Vector2d& position) {
  constexpr double kTolerance = 1e-3;
  std::vector<Vector2d> directions;
  for (const Face& face : plan.solid_faces) {
    if (DistanceToSegment(position, face.a, face.b) > kTolerance) continue;
    const Vector2d direction = (face.b - face.a).normalized();
    for (const Vector2d& other : directions) {
      if (std::abs(Cross(direction, other)) > 0.3) return true;
    }
    directions.push_back(direction);
  }
  return false;
}

}  // namespace survey
