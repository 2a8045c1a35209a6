// SPDX-License-Identifier: Apache-2.0
#include "survey/network/control_of_network.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "survey/network/approximations.h"
#include "survey/network/network_checks.h"

namespace survey {
namespace {

// Each suspect costs an adjustment; in a large network some observations always exceed the limit by chance.
std::size_t SuspectedAtMost(const Network& network) { return network.observations.size() > 5000 ? 3 : 20; }

constexpr double kSamePlaceM = 1e-4;
constexpr double kSmallestSigma = 1e-8;  // m and rad
constexpr double kLargestSigmaM = 100.0;
constexpr double kLargestSigmaRad = 0.5;

ControlPoint PointOf(const NetworkPoint& point, const PointResult& result, double scale, double fixed_sigma_m) {
  const double variance = scale * scale;
  ControlPoint control{.name = point.name, .position_in_site = result.position.head<2>()};
  control.covariance = point.IsUnknown(0)
                           ? Eigen::Matrix2d(variance * result.covariance.topLeftCorner<2, 2>())
                           : Eigen::Matrix2d(Eigen::Matrix2d::Identity() * fixed_sigma_m * fixed_sigma_m);
  if (point.height == CoordinateUse::kUnused) {
    if (point.height_known) control.elevation_m = point.position.z();
    return control;
  }
  control.elevation_m = result.position.z();
  control.elevation_sigma_m = point.IsUnknown(2) ? scale * std::sqrt(result.covariance(2, 2)) : fixed_sigma_m;
  return control;
}

AdjustmentSummary SummaryOf(const Network& network, const NetworkAdjustment& adjustment, std::size_t num_suspected,
                            double critical_w) {
  return {.software = "Plumbline",
          .description = network.description,
          .num_observations = adjustment.num_observations,
          .num_unknowns = adjustment.num_unknowns,
          .defect = adjustment.defect,
          .degrees_of_freedom = adjustment.degrees_of_freedom,
          .sigma_zero_a_priori = network.sigma_zero,
          .sigma_zero = adjustment.degrees_of_freedom > 0 ? network.sigma_zero * adjustment.VarianceRatioRoot() : 0.0,
          .scaled = network.use_sigma_a_posteriori && adjustment.degrees_of_freedom > 0,
          .confidence = network.confidence,
          .chi_square = adjustment.chi_square,
          .chi_square_lower = adjustment.chi_square_lower,
          .chi_square_upper = adjustment.chi_square_upper,
          .critical_w = critical_w,
          .largest_w = adjustment.largest_w,
          .num_uncontrolled = adjustment.num_untested,
          .num_suspected = static_cast<int>(num_suspected)};
}

std::vector<AdjustedObservation> ObservationsOf(const Network& network, const NetworkAdjustment& adjustment,
                                                const std::vector<SuspectedOutlier>& outliers) {
  const auto name_of = [&](int point) {
    return point < 0 ? std::string() : network.points[static_cast<std::size_t>(point)].name;
  };
  constexpr const char* kComponents[] = {" x", " y", " z"};
  std::vector<AdjustedObservation> observations;
  for (std::size_t k = 0; k < network.observations.size(); ++k) {
    const Observation& o = network.observations[k];
    const ObservationResult& result = adjustment.observations[k];
    AdjustedObservation& row = observations.emplace_back();
    row = {.kind = std::string(Name(o.kind)),
           .from = name_of(o.from),
           .to = name_of(o.to),
           .fore = name_of(o.fore),
           .angular = IsAngular(o.kind),
           .observed = o.value,
           .sigma = o.sigma,
           .adjusted = result.adjusted,
           .residual = result.residual,
           .sigma_adjusted = result.sigma_adjusted,
           .w = result.w,
           .redundancy = result.redundancy};
    if (o.kind == ObservationKind::kCoordinate || o.kind == ObservationKind::kDifference) {
      row.kind += kComponents[o.component];
    }
    if (std::isfinite(result.minimal_detectable_bias)) row.minimal_detectable_bias = result.minimal_detectable_bias;
  }
  for (std::size_t n = 0; n < outliers.size(); ++n) {
    observations[outliers[n].observation].suspected = static_cast<int>(n) + 1;
  }
  return observations;
}

// Covariances between adjusted points; `place` by control point: its index in the network.
std::vector<PointCorrelation> CorrelationsOf(const ControlNetwork& control, const std::vector<int>& place,
                                             const NetworkAdjustment& adjustment,
                                             const ControlOfNetworkOptions& options) {
  const std::set<std::string> always(options.correlate_always.begin(), options.correlate_always.end());
  const bool all = control.points.size() <= options.max_correlated;
  std::vector<int> chosen, indices;
  for (std::size_t i = 0; i < control.points.size(); ++i) {
    const bool adjusted = adjustment.unknowns.Coordinate(place[i], 0) >= 0;
    if (!adjusted || !(all || always.contains(control.points[i].name))) continue;
    chosen.push_back(static_cast<int>(i));
    indices.push_back(place[i]);
  }
  const Eigen::MatrixXd covariance = adjustment.CovarianceOf(indices);
  std::vector<PointCorrelation> correlations;
  for (std::size_t a = 0; a < chosen.size(); ++a) {
    for (std::size_t b = a + 1; b < chosen.size(); ++b) {
      const Eigen::Matrix2d block =
          covariance.block<2, 2>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b));
      if (!block.isZero(0.0)) correlations.push_back({chosen[a], chosen[b], block});
    }
  }
  return correlations;
}

std::string InWords(const Network& network, const Observation& o) {
  const auto name_of = [&](int point) { return network.points[static_cast<std::size_t>(point)].name; };
  return std::string(Name(o.kind)) + " from " + name_of(o.from) + (o.to < 0 ? "" : " to " + name_of(o.to));
}

// What no adjustment should be fed with; empty when all is well.
std::string AbsurdObservation(const Network& network) {
  for (const Observation& o : network.observations) {
    const double largest = IsAngular(o.kind) ? kLargestSigmaRad : kLargestSigmaM;
    if (!(o.sigma >= kSmallestSigma && o.sigma <= largest)) {
      return "the " + InWords(network, o) + " has the standard deviation " + std::to_string(o.sigma) +
             (IsAngular(o.kind) ? " rad" : " m") + ": is its unit right?";
    }
    const bool needs_room = IsAngular(o.kind) || o.kind == ObservationKind::kDistance;
    for (const int target : {o.to, o.fore}) {
      if (!needs_room || target < 0) continue;
      const Eigen::Vector3d apart = network.points[static_cast<std::size_t>(target)].position -
                                    network.points[static_cast<std::size_t>(o.from)].position;
      if ((network.geometry.geocentric ? apart.norm() : apart.head<2>().norm()) < kSamePlaceM) {
        return "the " + InWords(network, o) + " joins two points at the same place";
      }
    }
  }
  return "";
}

Network WithoutPoints(const Network& network, const std::vector<int>& points) {
  std::vector<bool> out(network.points.size(), false);
  for (const int i : points) out[static_cast<std::size_t>(i)] = true;
  return Without(network, out, std::vector<bool>(network.observations.size(), false));
}

// Finds approximate coordinates; what cannot be determined is a message, or is left out with a warning.
std::string Prepare(Network* network, bool leave_out, std::vector<std::string>* warnings) {
  while (true) {
    std::vector<int> undetermined;
    std::string message;
    for (const NetworkDefect& defect : CheckNetwork(*network)) {
      undetermined.insert(undetermined.end(), defect.points.begin(), defect.points.end());
      message += (message.empty() ? "" : "; ") + defect.message;
    }
    if (undetermined.empty()) {
      undetermined = ComputeApproximations(network);
      if (undetermined.empty()) return "";
      message = "no way is found from the known points to " + ListedNames(*network, undetermined) +
                ": give approximate coordinates, or observations that determine them";
    }
    if (!leave_out || undetermined.size() == network->points.size()) return message;
    warnings->push_back(message + "; left out");
    *network = WithoutPoints(*network, undetermined);
  }
}

}  // namespace

AdjustedControl AdjustControl(Network network, bool leave_out_undetermined, const ControlOfNetworkOptions& options) {
  AdjustedControl result;
  if (network.observations.empty()) {
    result.message = "the network holds no observations that can be used";
    return result;
  }
  result.message = Prepare(&network, leave_out_undetermined, &result.warnings);
  if (result.message.empty()) result.message = AbsurdObservation(network);
  const bool any_unknown = std::any_of(network.points.begin(), network.points.end(), [](const NetworkPoint& point) {
    return point.IsUnknown(0) || point.IsUnknown(2);
  });
  if (result.message.empty() && !any_unknown) result.message = "no point of the network is to be adjusted";
  if (!result.message.empty()) return result;
  const NetworkAdjustment adjustment = AdjustNetwork(network);
  result.message = adjustment.message;
  if (!adjustment.usable) return result;
  const std::vector<SuspectedOutlier> outliers = FindOutliers(network, adjustment, {}, SuspectedAtMost(network));
  result.control = ControlOf(network, adjustment, outliers, options);
  result.usable = true;
  return result;
}

ControlNetwork ControlOf(const Network& network, const NetworkAdjustment& adjustment,
                         const std::vector<SuspectedOutlier>& outliers, const ControlOfNetworkOptions& options) {
  std::vector<int> place;
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    if (network.points[i].plane != CoordinateUse::kUnused) place.push_back(static_cast<int>(i));
  }
  std::sort(place.begin(), place.end(), [&](int a, int b) {
    return network.points[static_cast<std::size_t>(a)].name < network.points[static_cast<std::size_t>(b)].name;
  });
  ControlNetwork control;
  for (const int i : place) {
    control.points.push_back(PointOf(network.points[static_cast<std::size_t>(i)],
                                     adjustment.points[static_cast<std::size_t>(i)], adjustment.scale,
                                     options.fixed_sigma_m));
  }
  control.correlations = CorrelationsOf(control, place, adjustment, options);
  control.adjustment = SummaryOf(network, adjustment, outliers.size(), CriticalW(TestLevel{}.significance));
  control.adjustment->degrees = options.degrees;
  control.observations = ObservationsOf(network, adjustment, outliers);
  return control;
}

}  // namespace survey
