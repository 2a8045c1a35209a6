// SPDX-License-Identifier: Apache-2.0
#include "survey/simulation/route.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "survey/stats/philox.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr double kStep = 0.02;          // between the samples of a path (m)
constexpr double kKnotStep = 0.1;       // of the motion's spline (s)
constexpr double kRest = 2.0;           // standing still before the first and after the last motion (s)
constexpr double kSettled = 0.3;        // the spline rests this long after a stop begins and before it ends (s)
constexpr double kSharpestTurn = 2.62;  // between two runs (150 degrees)

double AngleOf(const Vector2d& v) { return std::atan2(v.y(), v.x()); }

struct PathPoint {
  double s;  // distance along the path
  Vector2d position;
  double heading;  // not wrapped
  int waypoint;    // the one the path heads for
};

// A path driven without a stop, as a chain of points.
class Path {
 public:
  void Add(const Vector2d& position, double heading, int waypoint) {
    double s = 0.0;
    if (!points_.empty()) {
      s = points_.back().s + (position - points_.back().position).norm();
      heading = points_.back().heading + NormalizeAngle(heading - points_.back().heading);
      if (s < points_.back().s + 1e-9) return;
    }
    points_.push_back({s, position, heading, waypoint});
  }

  PathPoint At(double s) const {
    const auto after = std::lower_bound(points_.begin() + 1, points_.end() - 1, s,
                                        [](const PathPoint& point, double value) { return point.s < value; });
    const PathPoint& b = *after;
    const PathPoint& a = *(after - 1);
    const double f = std::clamp((s - a.s) / (b.s - a.s), 0.0, 1.0);
    return {s, a.position + f * (b.position - a.position), a.heading + f * (b.heading - a.heading), b.waypoint};
  }

  double Length() const { return points_.back().s; }
  const PathPoint& front() const { return points_.front(); }
  const PathPoint& back() const { return points_.back(); }

 private:
  std::vector<PathPoint> points_;
};

// A turn from one run to the next: a quintic Bezier curve whose first three control points lie on the one run and the
// last three on the other, so that the curvature is zero at both ends.
void AddTurn(const Vector2d& corner, const Vector2d& in, const Vector2d& out, double length, int waypoint, Path* path) {
  const std::array<Vector2d, 6> control = {corner - length * in,        corner - 0.6 * length * in,
                                           corner - 0.2 * length * in,  corner + 0.2 * length * out,
                                           corner + 0.6 * length * out, corner + length * out};
  constexpr int kSamples = 100;
  for (int i = 0; i <= kSamples; ++i) {
    const double u = static_cast<double>(i) / kSamples;
    std::array<Vector2d, 6> level = control;  // de Casteljau
    for (std::size_t depth = 5; depth > 1; --depth) {
      for (std::size_t j = 0; j < depth; ++j) level[j] += u * (level[j + 1] - level[j]);
    }
    path->Add(level[0] + u * (level[1] - level[0]), AngleOf(level[1] - level[0]), waypoint);
  }
}

// Distance along a path as a function of time: constant acceleration between samples.
class SpeedProfile {
 public:
  // `limit` bounds the speed at each sample; begins and ends at rest.
  SpeedProfile(double length, std::vector<double> limit, double acceleration)
      : step_(length / static_cast<double>(limit.size() - 1)), speed_(std::move(limit)) {
    speed_.front() = 0.0;
    speed_.back() = 0.0;
    const double gain = 2.0 * acceleration * step_;
    for (std::size_t i = 1; i < speed_.size(); ++i)
      speed_[i] = std::min(speed_[i], std::sqrt(speed_[i - 1] * speed_[i - 1] + gain));
    for (std::size_t i = speed_.size() - 1; i-- > 0;)
      speed_[i] = std::min(speed_[i], std::sqrt(speed_[i + 1] * speed_[i + 1] + gain));
    time_.push_back(0.0);
    for (std::size_t i = 1; i < speed_.size(); ++i)
      time_.push_back(time_.back() + 2.0 * step_ / (speed_[i - 1] + speed_[i]));
  }

  double Duration() const { return time_.back(); }

  double DistanceAt(double time) const {
    if (time >= time_.back()) return step_ * static_cast<double>(speed_.size() - 1);
    const auto after = static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), time) - time_.begin());
    const std::size_t i = after - 1;
    const double elapsed = time - time_[i];
    const double acceleration = (speed_[after] - speed_[i]) / (time_[after] - time_[i]);
    return step_ * static_cast<double>(i) + speed_[i] * elapsed + 0.5 * acceleration * elapsed * elapsed;
  }

 private:
  double step_;
  std::vector<double> speed_;
  std::vector<double> time_;
};

std::size_t SamplesOf(double length) { return static_cast<std::size_t>(std::max(8.0, std::ceil(length / kStep))) + 1; }

SpeedProfile ProfileOf(const Path& path, const CartSpec& cart) {
  const std::size_t count = SamplesOf(path.Length());
  const double step = path.Length() / static_cast<double>(count - 1);
  std::vector<double> limit;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = step * static_cast<double>(i);
    const double curvature = std::abs(path.At(s + 2 * step).heading - path.At(s - 2 * step).heading) / (4 * step);
    limit.push_back(std::min(cart.speed_m_s, cart.turn_rate_rad_s / std::max(curvature, 1e-6)));
  }
  return {path.Length(), std::move(limit), cart.acceleration_m_s2};
}

SpeedProfile ProfileOfTurn(double angle, const CartSpec& cart) {
  return {angle, std::vector<double>(SamplesOf(angle), cart.turn_rate_rad_s), cart.turn_acceleration_rad_s2};
}

struct Leg {
  Path path;
  std::string stop_at;  // point at its end; empty at the route's end without one
};

// The route as legs between stops, with the stops' places moved by the centring errors.
struct Legs {
  std::string first_stop;
  std::vector<Leg> legs;
};

class Planner {
 public:
  Planner(const Scenario& scenario, const BlockRoute& block, const RayCaster& building)
      : scenario_(scenario), block_(block), building_(building) {}

  RoutePlan Plan() {
    RoutePlan plan;
    if (!MakePlaces() || !MakeLegs() || !CheckClearance()) {
      plan.problem = problem_;
      plan.problem_waypoint = problem_waypoint_;
      return plan;
    }
    Drive(&plan);
    return plan;
  }

 private:
  bool Fail(int waypoint, const std::string& problem) {
    problem_ = problem;
    problem_waypoint_ = waypoint + 1;
    return false;
  }

  bool MakePlaces() {
    const RandomStream random(scenario_.seed, static_cast<std::uint32_t>(SimulationPurpose::kCentring),
                              StreamOfName(block_.name));
    std::uint64_t visit = 0;
    for (const Waypoint& waypoint : block_.waypoints) {
      Vector2d place = waypoint.position;
      if (!waypoint.point.empty()) {
        const auto [east, north] = random.Normals(visit++);
        place += scenario_.centring_sigma_m * Vector2d(east, north);
      }
      if (!places_.empty() && (place - places_.back()).norm() < 0.1)
        return Fail(static_cast<int>(places_.size()), "lies less than 0.1 m from the waypoint before it");
      places_.push_back(place);
    }
    if (places_.size() < 2) return Fail(0, "is alone: a route needs two waypoints");
    return true;
  }

  bool MakeLegs() {
    legs_.first_stop = block_.waypoints.front().point;
    std::size_t begin = 0;
    for (std::size_t end = 1; end < places_.size(); ++end) {
      if (block_.waypoints[end].point.empty() && end + 1 < places_.size()) continue;
      Leg leg{.stop_at = block_.waypoints[end].point};
      if (!MakePath(begin, end, &leg.path)) return false;
      legs_.legs.push_back(std::move(leg));
      begin = end;
    }
    return true;
  }

  bool MakePath(std::size_t begin, std::size_t end, Path* path) {
    Vector2d in = (places_[begin + 1] - places_[begin]).normalized();
    path->Add(places_[begin], AngleOf(in), static_cast<int>(begin));
    for (std::size_t i = begin + 1; i < end; ++i) {
      const Vector2d next = places_[i + 1] - places_[i];
      const Vector2d out = next.normalized();
      if (std::abs(NormalizeAngle(AngleOf(out) - AngleOf(in))) > kSharpestTurn)
        return Fail(static_cast<int>(i), "turns by more than 150 degrees: add waypoints or stop over a point");
      const double run = std::min((places_[i] - places_[i - 1]).norm(), next.norm());
      AddTurn(places_[i], in, out, std::min(scenario_.cart.corner_length_m, 0.5 * run), static_cast<int>(i), path);
      in = out;
    }
    path->Add(places_[end], AngleOf(in), static_cast<int>(end));
    return true;
  }

  bool CheckClearance() {
    const double clearance = scenario_.cart.clearance_m;
    for (const Leg& leg : legs_.legs) {
      const auto steps = static_cast<int>(std::ceil(leg.path.Length() / (0.25 * clearance)));
      for (int i = 0; i <= steps; ++i) {
        const PathPoint point = leg.path.At(leg.path.Length() * i / steps);
        const double free = building_.Clearance(point.position, clearance);
        if (free >= clearance) continue;
        const auto text = [](double value) {
          return std::to_string(value).substr(0, std::to_string(value).size() - 4);
        };
        return Fail(point.waypoint, "cannot be reached: at (" + text(point.position.x()) + ", " +
                                        text(point.position.y()) + ") the way leaves " + text(free) +
                                        " m to a wall, pillar, car or glass, the cart needs " + text(clearance) + " m");
      }
    }
    return true;
  }

  void Drive(RoutePlan* plan) {
    Hold(legs_.legs.front().path.front(), kRest);
    StopAt(legs_.first_stop, legs_.legs.front().path.front(), plan);
    for (std::size_t i = 0; i < legs_.legs.size(); ++i) {
      const Path& path = legs_.legs[i].path;
      if (i > 0) TurnTo(path.front());
      plan->length_m += path.Length();
      const SpeedProfile profile = ProfileOf(path, scenario_.cart);
      Append(profile.Duration(), [&](double time) {
        const PathPoint point = path.At(profile.DistanceAt(time));
        return Pose2{point.position.x(), point.position.y(), point.heading};
      });
      StopAt(legs_.legs[i].stop_at, path.back(), plan);
    }
    Hold(legs_.legs.back().path.back(), kRest);
    plan->trajectory.emplace(block_.start_s - kKnotStep, kKnotStep, std::move(knots_), scenario_.cart.body_from_lidar);
  }

  void StopAt(const std::string& point, const PathPoint& place, RoutePlan* plan) {
    if (point.empty()) return;
    const double start = block_.start_s + time_;
    Hold(place, scenario_.stop_s);
    plan->stops.push_back({point, start + kSettled, block_.start_s + time_ - kSettled});
  }

  // On the spot, before a leg that begins in another direction.
  void TurnTo(const PathPoint& next) {
    const double angle = NormalizeAngle(next.heading - yaw_);
    if (std::abs(angle) < 1e-3) return;
    const SpeedProfile profile = ProfileOfTurn(std::abs(angle), scenario_.cart);
    const double from = yaw_;
    Append(profile.Duration(), [&](double time) {
      return Pose2{next.position.x(), next.position.y(), from + std::copysign(profile.DistanceAt(time), angle)};
    });
  }

  void Hold(const PathPoint& place, double duration) {
    Append(duration, [&](double) { return Pose2{place.position.x(), place.position.y(), place.heading}; });
  }

  // Adds the knots that fall into the next `duration` seconds.
  template <typename Motion>
  void Append(double duration, const Motion& motion) {
    const double start_yaw = yaw_;
    const double first_yaw = motion(0.0).theta;
    const double turns = knots_.empty() ? 0.0 : start_yaw + NormalizeAngle(first_yaw - start_yaw) - first_yaw;
    while (kKnotStep * static_cast<double>(knots_.size()) <= time_ + duration) {
      const Pose2 pose = motion(kKnotStep * static_cast<double>(knots_.size()) - time_);
      const FloorShape floor = FloorAt(scenario_, pose.Translation());
      const double yaw = pose.theta + turns;
      const Vector2d forward(std::cos(yaw), std::sin(yaw));
      MotionVector knot;
      knot << pose.x, pose.y, floor.height_m, yaw, -std::atan(floor.slope.dot(forward)),
          std::atan(floor.slope.y() * forward.x() - floor.slope.x() * forward.y());
      knots_.push_back(knot);
    }
    time_ += duration;
    yaw_ = motion(duration).theta + turns;
  }

  const Scenario& scenario_;
  const BlockRoute& block_;
  const RayCaster& building_;
  std::vector<Vector2d> places_;
  Legs legs_;
  std::vector<MotionVector> knots_;
  double time_ = 0.0;  // since the first knot
  double yaw_ = 0.0;   // where the last motion ended
  std::string problem_;
  int problem_waypoint_ = 0;
};

}  // namespace

RoutePlan PlanRoute(const Scenario& scenario, const BlockRoute& block, const RayCaster& building) {
  return Planner(scenario, block, building).Plan();
}

FloorShape FloorAt(const Scenario& scenario, const Vector2d& p_in_plan) {
  constexpr std::uint64_t kWaves = 8;
  const RandomStream random(scenario.seed, static_cast<std::uint32_t>(SimulationPurpose::kFloor), 0);
  FloorShape floor;
  for (std::uint64_t i = 0; i < kWaves; ++i) {
    const auto [direction, phase] = random.Uniforms(i);
    const double wavelength = 3.0 + 1.5 * static_cast<double>(i);
    const double angle = 2.0 * std::numbers::pi * direction;
    const Vector2d wave = 2.0 * std::numbers::pi / wavelength * Vector2d(std::cos(angle), std::sin(angle));
    const double amplitude = scenario.cart.floor_tilt_rad * std::sqrt(2.0 / static_cast<double>(kWaves)) / wave.norm();
    const double argument = wave.dot(p_in_plan) + 2.0 * std::numbers::pi * phase;
    floor.height_m += amplitude * std::sin(argument);
    floor.slope += amplitude * std::cos(argument) * wave;
  }
  return floor;
}

}  // namespace survey
