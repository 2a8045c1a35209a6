// SPDX-License-Identifier: Apache-2.0
#include "formats/network_report.h"

#include <cmath>

#include "formats/angle_text.h"
#include "formats/text_table.h"
#include "survey/network/adjustment.h"

namespace formats {
namespace {

using survey::AdjustedObservation;
using survey::AdjustmentSummary;

std::string Mm(double metres) { return Number(1000.0 * metres, "%.2f"); }

// Angles in the unit of the network's file; small ones in cc or arc seconds.
class Angles {
 public:
  explicit Angles(bool degrees) : degrees_(degrees) {}
  std::string Whole(double rad) const { return degrees_ ? DmsText(rad, 2) : GonText(rad, 5); }
  std::string Small(double rad) const {
    return Number(rad / (degrees_ ? kRadPerDegree / 3600.0 : kRadPerGon * 1e-4), "%.2f");
  }
  std::string SmallUnit() const { return degrees_ ? "arc seconds" : "cc (0.0001 gon)"; }

 private:
  bool degrees_;
};

void PrintSummary(const AdjustmentSummary& s, std::ostream& out) {
  out << "\nadjustment of the control network by " << OneLine(s.software) << "\n";
  if (!s.description.empty()) out << "network                     " << OneLine(s.description) << "\n";
  out << "observations                " << s.num_observations << "\n"
      << "unknowns                    " << s.num_unknowns << "\n"
      << "datum                       "
      << (s.defect > 0 ? "free, defect " + std::to_string(s.defect) + " settled by the constrained coordinates"
                       : std::string("by fixed or observed coordinates"))
      << "\n"
      << "degrees of freedom          " << s.degrees_of_freedom << "\n"
      << "sigma zero a priori         " << Number(s.sigma_zero_a_priori, "%.5g") << "\n";
  if (s.degrees_of_freedom == 0) {
    out << "sigma zero a posteriori     none: no observation is redundant\n";
    return;
  }
  out << "sigma zero a posteriori     " << Number(s.sigma_zero, "%.5g") << " ("
      << (s.scaled ? "standard deviations of points are scaled by it" : "not applied to standard deviations") << ")\n"
      << "chi-square                  " << Number(s.chi_square, "%.3f") << "\n"
      << "chi-square test (" << Number(100.0 * s.confidence, "%.1f") << " %)    " << Number(s.chi_square_lower, "%.3f")
      << " < " << Number(s.chi_square, "%.3f") << " < " << Number(s.chi_square_upper, "%.3f")
      << (s.ChiSquareHolds()                  ? "  passed"
          : s.chi_square > s.chi_square_upper ? "  FAILED: observations are worse than their standard deviations say"
                                              : "  FAILED: observations are better than their standard deviations say")
      << "\n";
  if (s.critical_w == 0.0) return;
  out << "largest test statistic |w|  " << Number(s.largest_w, "%.2f") << " (critical " << Number(s.critical_w, "%.2f")
      << ")\n"
      << "suspected outliers          " << s.num_suspected << "\n"
      << "uncontrolled observations   " << s.num_uncontrolled << "\n";
}

void PrintEllipses(const survey::ControlNetwork& network, const Angles& angles, std::ostream& out) {
  out << "\nadjusted points (m; standard deviations and ellipses mm, one sigma; azimuth of the major axis)\n";
  TextTable({"point", "role", "easting", "northing", "height", "sd E", "sd N", "sd H", "a", "b", "azimuth"})
      .Print(out, [&](const auto& row) {
        for (const survey::ControlPoint& point : network.points) {
          const survey::ErrorEllipse ellipse = survey::EllipseOf(point.covariance);
          row({OneLine(point.name), std::string(Name(point.role)), Number(point.position_in_site.x(), "%.4f"),
               Number(point.position_in_site.y(), "%.4f"),
               point.elevation_m ? Number(*point.elevation_m, "%.4f") : std::string("-"),
               Mm(std::sqrt(point.covariance(0, 0))), Mm(std::sqrt(point.covariance(1, 1))),
               point.elevation_sigma_m ? Mm(*point.elevation_sigma_m) : std::string("-"), Mm(ellipse.semi_major),
               Mm(ellipse.semi_minor), angles.Whole(ellipse.azimuth)});
        }
      });
}

void PrintObservations(const survey::ControlNetwork& network, const Angles& angles, std::ostream& out) {
  out << "\nadjusted observations (m; residuals, standard deviations and MDB in mm or " << angles.SmallUnit()
      << "; adjusted minus observed; r redundancy; * suspected outlier, in the order found)\n";
  TextTable({"observation", "from", "to", "fore", "observed", "adjusted", "residual", "sd obs", "sd adj", "w", "r",
             "MDB", "*"})
      .Print(out, [&](const auto& row) {
        for (const AdjustedObservation& o : network.observations) {
          const auto whole = [&](double value) { return o.angular ? angles.Whole(value) : Number(value, "%.5f"); };
          const auto small = [&](double value) { return o.angular ? angles.Small(value) : Mm(value); };
          row({o.kind, OneLine(o.from), OneLine(o.to), OneLine(o.fore), whole(o.observed), whole(o.adjusted),
               small(o.residual), small(o.sigma), small(o.sigma_adjusted), Number(o.w, "%.2f"),
               Number(o.redundancy, "%.3f"),
               o.minimal_detectable_bias ? small(*o.minimal_detectable_bias) : std::string("-"),
               o.suspected > 0 ? "*" + std::to_string(o.suspected) : std::string()});
        }
      });
}

}  // namespace

void PrintNetworkReport(const survey::ControlNetwork& network, std::ostream& out) {
  for (const std::string& remark : network.remarks) out << "note: " << OneLine(remark) << "\n";
  if (!network.adjustment) return;
  const Angles angles(network.adjustment->degrees);
  PrintSummary(*network.adjustment, out);
  PrintEllipses(network, angles, out);
  if (!network.observations.empty()) PrintObservations(network, angles, out);
}

}  // namespace formats
