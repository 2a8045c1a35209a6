// SPDX-License-Identifier: Apache-2.0
#include "formats/starnet_weights.h"

#include <cmath>
#include <string>

#include "formats/angle_text.h"

namespace formats {
namespace {

using survey::ObservationKind;

constexpr double kArcSecond = kRadPerDegree / 3600.0;
constexpr double kFixedSigma = 1e-7;  // of an observation marked !, m or rad

// A default and the option that tells it; `unit` is that of the numbers on the line.
struct Default {
  double sigma = 0.0;
  double unit = 1.0;
  const char* option = "";
};

std::optional<double> Read(const Default& otherwise, StarnetLine* line) {
  if (line->More() && line->Peek().find('/') == std::string::npos) {
    const std::string text = line->Peek();
    if (text != "!" && text != "*" && text != "&") {
      const double sigma = line->Number("standard deviation");
      if (sigma <= 0.0) line->Fail("standard deviation = " + text + ": must be positive");
      return sigma * otherwise.unit;
    }
    line->Word("standard deviation");
    if (text == "!") return kFixedSigma;
    if (text == "*") return std::nullopt;
  }
  if (otherwise.sigma <= 0.0)
    line->Fail(std::string("has no standard deviation, and the option ") + otherwise.option + " gives no default");
  return otherwise.sigma;
}

double DistanceSigma(const StarnetSigmas& defaults, double distance) {
  return defaults.distance_m > 0.0 ? defaults.distance_m + 1e-6 * defaults.distance_ppm * distance : 0.0;
}

}  // namespace

std::optional<double> ReadStarnetLevelSigma(double length_km, const StarnetSigmas& defaults,
                                            const StarnetSettings& settings, StarnetLine* line) {
  return Read({defaults.levelling_m_per_sqrt_km * std::sqrt(length_km), settings.metres_per_unit,
               "starnet-levelling-sigma-m-per-sqrt-km"},
              line);
}

std::optional<double> ReadStarnetSigma(const survey::Observation& observation, const StarnetSigmas& defaults,
                                       const StarnetSettings& settings, StarnetLine* line) {
  switch (observation.kind) {
    case ObservationKind::kAzimuth:
      return Read({defaults.azimuth_arcsec * kArcSecond, kArcSecond, "starnet-azimuth-sigma-arcsec"}, line);
    case ObservationKind::kAngle:
    case ObservationKind::kDirection:
      return Read({defaults.angle_arcsec * kArcSecond, kArcSecond, "starnet-angle-sigma-arcsec"}, line);
    case ObservationKind::kZenithAngle:
      return Read({defaults.zenith_arcsec * kArcSecond, kArcSecond, "starnet-zenith-sigma-arcsec"}, line);
    case ObservationKind::kHeightDifference:
      return ReadStarnetLevelSigma(1.0, defaults, settings, line);
    default:
      return Read({DistanceSigma(defaults, observation.value), settings.metres_per_unit, "starnet-distance-sigma-m"},
                  line);
  }
}

}  // namespace formats
