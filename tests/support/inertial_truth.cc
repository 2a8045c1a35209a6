// SPDX-License-Identifier: Apache-2.0
#include "tests/support/inertial_truth.h"

#include <array>
#include <cmath>

namespace test_support {
namespace {

using Eigen::Vector3d;
using survey::Earth;

Vector3d PlaceRate(const Motion& motion, const Place& place) {
  const Earth earth = survey::EarthAt(place.latitude_rad, place.height_m);
  return {motion.v.y() / earth.meridian_radius_m,
          motion.v.x() / (earth.transverse_radius_m * std::cos(place.latitude_rad)), motion.v.z()};
}

Place Moved(const Place& place, const Vector3d& by) {
  return {place.latitude_rad + by.x(), place.longitude_rad + by.y(), place.height_m + by.z()};
}

int PiecesOf(double span, double step) { return std::max(1, static_cast<int>(std::ceil(span / step - 1e-9))); }

}  // namespace

Place Travel(const MotionOfTime& motion, Place place, double from_s, double to_s, double step_s) {
  const int pieces = PiecesOf(to_s - from_s, step_s);
  const double h = (to_s - from_s) / pieces;
  for (int i = 0; i < pieces; ++i) {
    const double t = from_s + i * h;
    const Motion middle = motion(t + 0.5 * h);
    const Vector3d a = PlaceRate(motion(t), place);
    const Vector3d b = PlaceRate(middle, Moved(place, 0.5 * h * a));
    const Vector3d c = PlaceRate(middle, Moved(place, 0.5 * h * b));
    const Vector3d d = PlaceRate(motion(t + h), Moved(place, h * c));
    place = Moved(place, h / 6.0 * (a + 2.0 * b + 2.0 * c + d));
  }
  return place;
}

survey::ImuIncrement ExactIncrement(const MotionOfTime& motion, const Place& place, double from_s, double to_s,
                                    double step_s) {
  static const std::array<double, 3> kNodes = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  survey::ImuIncrement sum{.dt_s = to_s - from_s};
  const int pieces = PiecesOf(to_s - from_s, step_s);
  const double h = (to_s - from_s) / pieces;
  for (int i = 0; i < pieces; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double t = from_s + (i + 0.5 + 0.5 * kNodes[k]) * h;
      const Motion now = motion(t);
      const Place here = Moved(place, (t - from_s) * PlaceRate(now, place));
      const Earth earth = survey::EarthAt(here.latitude_rad, here.height_m);
      const Vector3d transport = survey::TransportRate(earth, now.v);
      const Eigen::Quaterniond body_from_nav = now.nav_from_body.conjugate();
      const Vector3d turn = earth.rotation_in_nav + transport;
      const Vector3d force = now.dv + (turn + earth.rotation_in_nav).cross(now.v) - earth.gravity_in_nav;
      sum.dtheta += kWeights[k] * h * (now.rate_in_body + body_from_nav * turn);
      sum.dvel += kWeights[k] * h * (body_from_nav * force);
    }
  }
  return sum;
}

DeadReckoning Reckon(const MotionOfTime& motion, const Place& start, double from_s, double to_s, double dt_s) {
  constexpr double kFine_s = 0.005;
  const Motion first = motion(from_s);
  DeadReckoning reckoned;
  reckoned.state = {survey::EcefFromNav({start.latitude_rad, start.longitude_rad}), start.height_m, first.v,
                    first.nav_from_body};
  reckoned.place = start;
  survey::ImuIncrement previous;
  const int steps = PiecesOf(to_s - from_s, dt_s);
  for (int i = 0; i < steps; ++i) {
    const double t = from_s + i * dt_s;
    const survey::ImuIncrement now = ExactIncrement(motion, reckoned.place, t, t + dt_s, kFine_s);
    reckoned.state = survey::Mechanize(reckoned.state, previous, now);
    reckoned.place = Travel(motion, reckoned.place, t, t + dt_s, kFine_s);
    previous = now;
  }
  reckoned.motion = motion(from_s + steps * dt_s);
  return reckoned;
}

NavigationError ErrorOf(const DeadReckoning& reckoned) {
  const survey::GeodeticPlace place = survey::PlaceOf(reckoned.state.ecef_from_nav);
  const Earth earth = survey::EarthAt(reckoned.place.latitude_rad, reckoned.place.height_m);
  const Vector3d offset(
      (place.latitude_rad - reckoned.place.latitude_rad) * earth.meridian_radius_m,
      (place.longitude_rad - reckoned.place.longitude_rad) * earth.transverse_radius_m * std::cos(place.latitude_rad),
      reckoned.state.height_m - reckoned.place.height_m);
  return {offset.norm(), (reckoned.state.v_in_nav - reckoned.motion.v).norm(),
          survey::ToRotationVector(reckoned.state.nav_from_body * reckoned.motion.nav_from_body.conjugate()).norm()};
}

void SetAttitude(const Vector3d& phi, const Vector3d& dphi, Motion* motion) {
  motion->nav_from_body = survey::FromRotationVector(phi);
  // Right Jacobian of SO(3) times the derivative.
  const double angle = phi.norm();
  const double a = angle > 1e-6 ? (1.0 - std::cos(angle)) / (angle * angle) : 0.5;
  const double b = angle > 1e-6 ? (angle - std::sin(angle)) / (angle * angle * angle) : 1.0 / 6.0;
  motion->rate_in_body = dphi - a * phi.cross(dphi) + b * phi.cross(phi.cross(dphi));
}

}  // namespace test_support
