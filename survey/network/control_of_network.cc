// SPDX-License-Identifier: Apache-2.0
#include "survey/network/control_of_network.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace survey {
namespace {

ControlPoint PointOf(const NetworkPoint& point, const PointResult& result, double scale, double fixed_sigma_m) {
  const double variance = scale * scale;
  ControlPoint control{.name = point.name, .position_in_site = result.position.head<2>()};
  control.covariance = point.IsUnknown(0) ? Eigen::Matrix2d(variance * result.covariance.topLeftCorner<2, 2>())
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

}  // namespace

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
  control.adjustment = SummaryOf(network, adjustment, outliers.size(), CriticalW(0.001));
  control.observations = ObservationsOf(network, adjustment, outliers);
  return control;
}

}  // namespace survey
