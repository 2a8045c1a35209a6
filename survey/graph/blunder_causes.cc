// SPDX-License-Identifier: Apache-2.0
#include "survey/graph/blunder_causes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "survey/stats/mahalanobis.h"

namespace survey {
namespace {

constexpr double kFitSignificance = 0.001;
constexpr double kLargestDelay_s = 10.0;
constexpr double kDelayStep_s = 0.05;

std::string Metres(double value, const char* format = "%.3f m") {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string Coordinate(double value) { return Metres(value, "%.3f"); }

double SquaredDistance(const PlaceByOthers& point, const Eigen::Vector2d& place) {
  return SquaredMahalanobis(place - point.Place(), point.covariance);
}

// The value with one digit wrong or two neighbouring digits exchanged that fits within three sigmas; digits down to the
// centimetre.
std::optional<double> RetypedValue(double given, double fitting, double sigma) {
  const double digits = std::floor(std::abs(given) * 100.0 + 0.5);
  const double rest = std::abs(given) - digits / 100.0;
  const double sign = given < 0.0 ? -1.0 : 1.0;
  const auto digit = [&](double power) { return std::fmod(std::floor(digits / power), 10.0); };
  std::optional<double> best;
  double least = 3.0 * sigma;
  const auto consider = [&](double changed) {
    const double value = sign * (changed / 100.0 + rest);
    if (std::abs(value - fitting) > least) return;
    least = std::abs(value - fitting);
    best = value;
  };
  for (double power = 1.0; 10.0 * power <= digits; power *= 10.0) {
    consider(digits + (digit(power) - digit(10.0 * power)) * 9.0 * power);
  }
  if (best) return best;
  for (double power = 1.0; power <= digits; power *= 10.0) {
    if (30.0 * sigma > power / 100.0) continue;  // some digit would always fit
    for (double other = 0.0; other < 10.0; other += 1.0) consider(digits + (other - digit(power)) * power);
  }
  return best;
}

std::string Joined(const std::string& point, const PlaceByOthers& place, const std::vector<std::string>& causes) {
  std::string text = "mark on " + point + " was left out: the others put it " + Metres(place.error.norm()) + " away";
  for (const std::string& cause : causes) text += (&cause == &causes.front() ? "; " : ", or ") + cause;
  return text;
}

std::optional<std::string> OtherLabel(const SuspectMark& suspect, const std::vector<NamedPlace>& points) {
  const NamedPlace* nearest = nullptr;
  for (const NamedPlace& point : points) {
    if (point.name == suspect.point || !suspect.place.Fits(point.given)) continue;
    const auto distance = [&](const NamedPlace& each) { return (each.given - suspect.place.Place()).norm(); };
    if (nearest == nullptr || distance(point) < distance(*nearest)) nearest = &point;
  }
  if (nearest == nullptr) return std::nullopt;
  return "it looks like a mark on " + nearest->name + " (" + Metres((nearest->given - suspect.place.Place()).norm()) +
         " away)";
}

std::string ExchangeSentence(const SuspectMark& a, const SuspectMark& b) {
  const auto after = [](const SuspectMark& mark, const SuspectMark& other) {
    return Metres((other.place.given - mark.place.Place()).norm());
  };
  return a.point + " and " + b.point + " look exchanged: " + after(a, b) + " and " + after(b, a) + " after exchange, " +
         Metres(a.place.error.norm()) + " and " + Metres(b.place.error.norm()) + " before; both were left out";
}

}  // namespace

bool PlaceByOthers::Fits(const Eigen::Vector2d& place) const {
  return SquaredDistance(*this, place) < CriticalT(kFitSignificance, 2);
}

std::optional<std::string> MistypedCoordinates(const PlaceByOthers& point) {
  const Eigen::Vector2d turned(point.given.y(), point.given.x());
  if (point.Fits(turned)) return "easting and northing look exchanged";
  for (const int axis : {0, 1}) {
    const double sigma = std::sqrt(point.covariance(axis, axis));
    if (std::abs(point.error[axis]) < 5.0 * sigma) continue;
    const auto value = RetypedValue(point.given[axis], point.Place()[axis], sigma);
    if (!value) continue;
    Eigen::Vector2d corrected = point.given;
    corrected[axis] = *value;
    if (!point.Fits(corrected)) continue;
    return std::string(axis == 0 ? "easting " : "northing ") + Coordinate(point.given[axis]) +
           " looks mistyped: " + Coordinate(*value) + " would fit to " + Metres((corrected - point.Place()).norm());
  }
  return std::nullopt;
}

std::optional<std::string> WrongTime(const PlaceByOthers& point, const MotionOfMark& motion) {
  if (!motion) return std::nullopt;
  double least = CriticalT(kFitSignificance, 2);
  double best = 0.0;
  for (int step = 1; step <= static_cast<int>(kLargestDelay_s / kDelayStep_s); ++step) {
    for (const double sign : {-1.0, 1.0}) {
      const double delay = sign * step * kDelayStep_s;
      const std::optional<Eigen::Vector2d> moved = motion(delay);
      // The place is where the platform stood at the other time.
      if (!moved) continue;
      const double misfit = SquaredDistance(point, point.given - *moved);
      if (misfit >= least) continue;
      least = misfit;
      best = delay;
    }
  }
  if (best == 0.0) return std::nullopt;
  char text[64];
  std::snprintf(text, sizeof text, "it would fit %.1f s %s", std::abs(best), best > 0.0 ? "later" : "earlier");
  return text;
}

std::vector<std::string> ExplainBlunders(const std::vector<SuspectMark>& suspects,
                                         const std::vector<std::pair<int, int>>& exchanged,
                                         const std::vector<NamedPlace>& points) {
  std::vector<std::string> sentences(suspects.size());
  const auto exchange = [&](std::size_t a, std::size_t b) {
    sentences[a] = sentences[b] = ExchangeSentence(suspects[a], suspects[b]);
  };
  for (const auto& [a, b] : exchanged) exchange(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  for (std::size_t a = 0; a < suspects.size(); ++a) {
    for (std::size_t b = a + 1; b < suspects.size(); ++b) {
      if (!sentences[a].empty() || !sentences[b].empty() || suspects[a].point == suspects[b].point) continue;
      if (suspects[a].place.Fits(suspects[b].place.given) && suspects[b].place.Fits(suspects[a].place.given))
        exchange(a, b);
    }
  }
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    if (!sentences[i].empty()) continue;
    const SuspectMark& suspect = suspects[i];
    std::vector<std::string> causes;
    if (auto label = OtherLabel(suspect, points)) causes.push_back(*std::move(label));
    if (auto mistyped = MistypedCoordinates(suspect.place)) causes.push_back(*std::move(mistyped));
    if (auto time = WrongTime(suspect.place, suspect.motion)) causes.push_back(*std::move(time));
    sentences[i] = Joined(suspect.point, suspect.place, causes);
  }
  return sentences;
}

}  // namespace survey
