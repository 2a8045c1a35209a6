// SPDX-License-Identifier: Apache-2.0
#include "survey/network/plane_piece.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "survey/geometry/segment.h"

namespace survey {
namespace {

using Eigen::Vector2d;

constexpr double kSharpestCut = 0.03;  // sine of the angle at which two rays may still be intersected

Vector2d Towards(double azimuth) { return {std::sin(azimuth), std::cos(azimuth)}; }

double Azimuth(const Vector2d& from, const Vector2d& to) { return std::atan2(to.x() - from.x(), to.y() - from.y()); }

// Least-squares similarity (or rigid motion) from pairs.
struct Similarity {
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();  // scaled
  Vector2d from_centre = Vector2d::Zero(), to_centre = Vector2d::Zero();
  Vector2d operator()(const Vector2d& p) const { return to_centre + turn * (p - from_centre); }
};

std::optional<Similarity> Fit(const std::vector<Vector2d>& from, const std::vector<Vector2d>& to, bool rigid) {
  if (from.size() < 2) return std::nullopt;
  Similarity fit;
  for (std::size_t i = 0; i < from.size(); ++i) {
    fit.from_centre += from[i] / static_cast<double>(from.size());
    fit.to_centre += to[i] / static_cast<double>(to.size());
  }
  double a = 0.0, b = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vector2d p = from[i] - fit.from_centre, q = to[i] - fit.to_centre;
    a += p.dot(q);
    b += Cross(p, q);
    squares += p.squaredNorm();
  }
  const double size = rigid ? std::hypot(a, b) : squares;
  if (squares == 0.0 || size == 0.0) return std::nullopt;
  fit.turn << a / size, -b / size, b / size, a / size;
  return fit;
}

}  // namespace

PlanePiece::PlanePiece(const Sights& sights, bool metric, bool has_north)
    : sights_(&sights),
      metric_(metric),
      has_north_(has_north),
      known_(sights.bundles_of.size(), false),
      positions_(sights.bundles_of.size(), Vector2d::Zero()) {}

void PlanePiece::Set(int point, const Vector2d& position) {
  const auto i = static_cast<std::size_t>(point);
  if (!known_[i]) {
    ++size_;
    points_.push_back(point);
  }
  known_[i] = true;
  positions_[i] = position;
}

bool PlanePiece::Grow() {
  bool grew = false;
  for (bool more = true; more;) {
    more = false;
    for (int point = 0; point < static_cast<int>(known_.size()); ++point) {
      if (Knows(point)) continue;
      if (const std::optional<Vector2d> position = Locate(point)) {
        Set(point, *position);
        grew = more = true;
      }
    }
  }
  return grew;
}

bool PlanePiece::Attach(const PlanePiece& other) {
  std::vector<Vector2d> from, to;
  for (const int point : other.points_) {
    if (!Knows(point)) continue;
    from.push_back(other.At(point));
    to.push_back(At(point));
  }
  const std::optional<Similarity> fit = Fit(from, to, other.metric_);
  if (!fit) return false;
  for (const int point : other.points_) {
    if (!Knows(point)) Set(point, (*fit)(other.At(point)));
  }
  return true;
}

// Azimuth of reading zero, from the station and all targets that are known.
std::optional<double> PlanePiece::Orientation(const Bundle& bundle) const {
  if (bundle.oriented && has_north_) return 0.0;
  double sine = 0.0, cosine = 0.0;
  for (const Ray& ray : bundle.rays) {
    if (!Knows(ray.target)) continue;
    const double orientation = Azimuth(At(bundle.station), At(ray.target)) - ray.reading;
    sine += std::sin(orientation);
    cosine += std::cos(orientation);
  }
  if (sine == 0.0 && cosine == 0.0) return std::nullopt;
  return std::atan2(sine, cosine);
}

std::optional<Vector2d> PlanePiece::Locate(int point) const {
  for (const auto method : {&PlanePiece::ByShift, &PlanePiece::ByPolar, &PlanePiece::ByFreeStation,
                            &PlanePiece::ByIntersection, &PlanePiece::ByResection, &PlanePiece::ByLengths}) {
    if (const std::optional<Vector2d> position = (this->*method)(point)) return position;
  }
  return std::nullopt;
}

std::optional<Vector2d> PlanePiece::ByShift(int point) const {
  if (!metric_ || !has_north_) return std::nullopt;
  std::optional<double> found[2];
  for (const Sights::Shift& shift : sights_->shifts[static_cast<std::size_t>(point)]) {
    if (Knows(shift.other)) found[shift.component] = At(shift.other)[shift.component] - shift.value;
  }
  if (!found[0] || !found[1]) return std::nullopt;
  return Vector2d(*found[0], *found[1]);
}

std::optional<Vector2d> PlanePiece::ByPolar(int point) const {
  if (!metric_) return std::nullopt;
  for (const Sights::Incoming& ray : sights_->incoming[static_cast<std::size_t>(point)]) {
    const Bundle& bundle = sights_->bundles[static_cast<std::size_t>(ray.bundle)];
    if (!Knows(bundle.station)) continue;
    const std::optional<double> distance = sights_->Distance(bundle.station, point);
    const std::optional<double> orientation = Orientation(bundle);
    if (distance && orientation) return At(bundle.station) + *distance * Towards(*orientation + ray.reading);
  }
  // An azimuth from the point itself.
  for (const int index : sights_->bundles_of[static_cast<std::size_t>(point)]) {
    const Bundle& bundle = sights_->bundles[static_cast<std::size_t>(index)];
    if (!bundle.oriented || !has_north_ || !Knows(bundle.rays.front().target)) continue;
    const std::optional<double> distance = sights_->Distance(point, bundle.rays.front().target);
    if (distance) return At(bundle.rays.front().target) - *distance * Towards(bundle.rays.front().reading);
  }
  return std::nullopt;
}

// The polar coordinates of at least two known targets, fitted to them.
std::optional<Vector2d> PlanePiece::ByFreeStation(int point) const {
  if (!metric_) return std::nullopt;
  for (const int index : sights_->bundles_of[static_cast<std::size_t>(point)]) {
    std::vector<Vector2d> from, to;
    for (const Ray& ray : sights_->bundles[static_cast<std::size_t>(index)].rays) {
      const std::optional<double> distance = sights_->Distance(point, ray.target);
      if (!Knows(ray.target) || !distance) continue;
      from.push_back(*distance * Towards(ray.reading));
      to.push_back(At(ray.target));
    }
    if (const std::optional<Similarity> fit = Fit(from, to, true)) return (*fit)(Vector2d::Zero());
  }
  return std::nullopt;
}

std::optional<Vector2d> PlanePiece::ByIntersection(int point) const {
  struct Line {
    Vector2d origin, direction;
  };
  std::vector<Line> lines;
  for (const Sights::Incoming& ray : sights_->incoming[static_cast<std::size_t>(point)]) {
    const Bundle& bundle = sights_->bundles[static_cast<std::size_t>(ray.bundle)];
    if (!Knows(bundle.station)) continue;
    if (const std::optional<double> orientation = Orientation(bundle)) {
      lines.push_back({At(bundle.station), Towards(*orientation + ray.reading)});
    }
  }
  double best_cut = kSharpestCut;
  std::optional<Vector2d> best;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      const double cut = Cross(lines[i].direction, lines[j].direction);
      const Vector2d base = lines[j].origin - lines[i].origin;
      if (std::abs(cut) < best_cut || base.norm() == 0.0) continue;
      const double along_i = Cross(base, lines[j].direction) / cut, along_j = Cross(base, lines[i].direction) / cut;
      if (along_i <= 0.0 || along_j <= 0.0) continue;  // behind an instrument
      best_cut = std::abs(cut);
      best = lines[i].origin + along_i * lines[i].direction;
    }
  }
  return best;
}

// Readings r_i to known (E_i, N_i) from (E, N) with the orientation o: (E_i - E) cos(r_i + o) = (N_i - N) sin(r_i + o)
// is linear and homogeneous in a = cos o, b = sin o, p = N b - E a, q = E b + N a.
std::optional<Vector2d> PlanePiece::ByResection(int point) const {
  for (const int index : sights_->bundles_of[static_cast<std::size_t>(point)]) {
    std::vector<const Ray*> rays;
    Vector2d centre = Vector2d::Zero();
    for (const Ray& ray : sights_->bundles[static_cast<std::size_t>(index)].rays) {
      if (!Knows(ray.target)) continue;
      rays.push_back(&ray);
      centre += At(ray.target);
    }
    if (rays.size() < 3) continue;
    centre /= static_cast<double>(rays.size());
    double size = 0.0;
    for (const Ray* ray : rays) size = std::max(size, (At(ray->target) - centre).norm());
    if (size == 0.0) continue;
    Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();  // of the equations e u = 0, one by ray
    for (const Ray* ray : rays) {
      const Vector2d t = (At(ray->target) - centre) / size;
      const double s = std::sin(ray->reading), c = std::cos(ray->reading);
      const Eigen::Vector4d e(t.x() * c - t.y() * s, -t.x() * s - t.y() * c, c, s);
      squares += e * e.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(squares);
    if (eigen.eigenvalues()[1] < 1e-6 * eigen.eigenvalues()[3]) continue;  // near the danger circle
    const Eigen::Vector4d u = eigen.eigenvectors().col(0);
    const double norm = u[0] * u[0] + u[1] * u[1];
    if (norm < 1e-12) continue;
    const Vector2d place((-u[0] * u[2] + u[1] * u[3]) / norm, (u[1] * u[2] + u[0] * u[3]) / norm);
    const Vector2d position = centre + size * place;
    // All targets must lie ahead, or all behind (then the orientation turns by half a circle).
    int ahead = 0;
    for (const Ray* ray : rays) {
      const Vector2d towards = Towards(ray->reading + std::atan2(u[1], u[0]));
      ahead += towards.dot(At(ray->target) - position) > 0.0 ? 1 : -1;
    }
    if (std::abs(ahead) == static_cast<int>(rays.size())) return position;
  }
  return std::nullopt;
}

// How badly a place fits the other observations that can tell: lengths, and angles between known targets, in metres.
double PlanePiece::Misfit(int point, const Vector2d& candidate) const {
  double sum = 0.0;
  for (const Sights::Length& length : sights_->lengths[static_cast<std::size_t>(point)]) {
    if (Knows(length.other)) sum += std::abs((At(length.other) - candidate).norm() - length.distance);
  }
  for (const int index : sights_->bundles_of[static_cast<std::size_t>(point)]) {
    const Ray* first = nullptr;
    for (const Ray& ray : sights_->bundles[static_cast<std::size_t>(index)].rays) {
      if (!Knows(ray.target)) continue;
      if (first == nullptr) {
        first = &ray;
        continue;
      }
      const double angle = Azimuth(candidate, At(ray.target)) - Azimuth(candidate, At(first->target));
      const double difference = std::remainder(angle - (ray.reading - first->reading), 2.0 * M_PI);
      sum += std::abs(difference) * (At(ray.target) - candidate).norm();
    }
  }
  for (const Sights::Incoming& ray : sights_->incoming[static_cast<std::size_t>(point)]) {
    const Bundle& bundle = sights_->bundles[static_cast<std::size_t>(ray.bundle)];
    if (!Knows(bundle.station)) continue;
    const std::optional<double> orientation = Orientation(bundle);
    if (!orientation) continue;
    const double difference =
        std::remainder(Azimuth(At(bundle.station), candidate) - *orientation - ray.reading, 2.0 * M_PI);
    sum += std::abs(difference) * (At(bundle.station) - candidate).norm();
  }
  return sum;
}

// Two circles meet in two places: taken is the one that other observations confirm.
std::optional<Vector2d> PlanePiece::ByLengths(int point) const {
  if (!metric_) return std::nullopt;
  const std::vector<Sights::Length>& lengths = sights_->lengths[static_cast<std::size_t>(point)];
  double best_cut = kSharpestCut;
  std::optional<std::pair<Vector2d, Vector2d>> best;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    for (std::size_t j = i + 1; j < lengths.size(); ++j) {
      if (!Knows(lengths[i].other) || !Knows(lengths[j].other)) continue;
      const Vector2d base = At(lengths[j].other) - At(lengths[i].other);
      const double b = base.norm();
      if (b == 0.0) continue;
      const double along =
          (lengths[i].distance * lengths[i].distance - lengths[j].distance * lengths[j].distance + b * b) / (2.0 * b);
      const double square = lengths[i].distance * lengths[i].distance - along * along;
      if (square <= 0.0) continue;
      const double across = std::sqrt(square), cut = across * b / (lengths[i].distance * lengths[j].distance);
      if (cut < best_cut) continue;
      best_cut = cut;
      const Vector2d foot = At(lengths[i].other) + base * (along / b), normal(-base.y() / b, base.x() / b);
      best.emplace(foot + across * normal, foot - across * normal);
    }
  }
  if (!best) return std::nullopt;
  const double first = Misfit(point, best->first), second = Misfit(point, best->second);
  const double apart = (best->first - best->second).norm();
  if (std::abs(first - second) < 0.2 * apart) return std::nullopt;  // nothing tells them apart
  return first < second ? best->first : best->second;
}

}  // namespace survey
