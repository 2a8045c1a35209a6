// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_control.h"

#include <cmath>

#include "formats/html.h"

namespace formats {
namespace {

using survey::Certificate;

std::string CrossValidationSection(const Certificate& c) {
  if (!c.cross_validation) return "";
  const survey::ErrorStatistics& s = c.cross_validation->statistics;
  HtmlTable table({"points n (errors)", "RMSE<sub>H1</sub>", "RMSE<sub>H</sub>", "95 % interval of H1",
                   "mean east / north", "largest", "mean d'C<sup>&minus;1</sup>d / 2"},
                  0);
  table.Row(
      {std::to_string(s.num_points) + " (" + std::to_string(s.num_errors) + ")", Millimetres(s.rmse),
       Millimetres(s.rmse_product),
       s.rmse_bounds_95 ? Millimetres(s.rmse_bounds_95->low) + " to " + Millimetres(s.rmse_bounds_95->high) : "&ndash;",
       Millimetres(s.mean.x()) + " / " + Millimetres(s.mean.y()), Millimetres(s.max),
       c.cross_validation->normalised_square ? Fixed(*c.cross_validation->normalised_square, 2) : "&ndash;"});
  return H2("Control cross-validated (leave one out)") +
         P("d = where all other control of the block puts the point, minus its coordinates; mm; each d is listed under "
           "reliability (LOO). <b>Not a test</b> on independent points and in no verdict: the points were chosen for "
           "the map and hold it. Last column: 1 where the &sigma; are honest.",
           "note lead") +
         table.Text();
}

std::string FitSection(const Certificate& c) {
  if (c.fit.empty()) return "";
  HtmlTable table({"point", "block", "east (m)", "north (m)", "before dE", "before dN", "after dE", "after dN"}, 2);
  for (const survey::FitResidual& fit : c.fit) {
    table.Row({Escaped(fit.point), Escaped(fit.block), Fixed(fit.given.x(), 3), Fixed(fit.given.y(), 3),
               Millimetres(fit.rigid_residual.x()), Millimetres(fit.rigid_residual.y()), Millimetres(fit.residual.x()),
               Millimetres(fit.residual.y())});
  }
  return H2("Control used (fit)") +
         P("These residuals are <b>not an accuracy</b>: the adjustment was told these coordinates. Before: after a "
           "rigid "
           "fit of the whole block; after: adjusted; mm.",
           "note lead") +
         table.Text();
}

// How the control was adjusted and brought into the site's system.
std::string ControlNetworkText(const Certificate& c) {
  std::string html;
  if (c.control_adjustment) {
    const survey::AdjustmentSummary& s = *c.control_adjustment;
    html += "Adjusted by " + Escaped(s.software) + (s.description.empty() ? "" : " (" + Escaped(s.description) + ")") +
            ": " + Count(s.num_observations, "observation") + ", " + Count(s.num_unknowns, "unknown") + ", datum " +
            (s.defect > 0 ? "free (defect " + std::to_string(s.defect) + ")" : "fixed") + ". ";
    if (s.degrees_of_freedom > 0) {
      html += "&sigma;<sub>0</sub> a posteriori " + Fixed(s.sigma_zero / s.sigma_zero_a_priori, 3) +
              " of the a priori value; &chi;&sup2; test at " + Fixed(100 * s.confidence, 0) +
              " %: " + Fixed(s.chi_square_lower, 2) + " &lt; " + Fixed(s.chi_square, 2) + " &lt; " +
              Fixed(s.chi_square_upper, 2) + (s.ChiSquareHolds() ? " passed" : " <b>failed</b>") + ". ";
    } else {
      html += "No redundancy: nothing was tested. ";
    }
    if (s.num_suspected > 0) html += Count(s.num_suspected, "observation") + " suspected as outliers, all kept. ";
    if (s.num_uncontrolled > 0) html += Count(s.num_uncontrolled, "observation") + " not controlled by any other. ";
  }
  for (const std::string& remark : c.control_remarks) html += Escaped(remark) + ". ";
  return html.empty() ? "" : P(html, "note");
}

}  // namespace

std::string ControlUsedSection(const Certificate& c) { return CrossValidationSection(c) + FitSection(c); }

std::string ControlListSection(const Certificate& c) {
  HtmlTable table({"point", "role", "description", "east (m)", "north (m)", "&sigma;E (mm)", "&sigma;N (mm)"}, 3);
  bool any = false;
  for (const survey::ControlPoint& point : c.points) {
    if (point.role == survey::PointRole::kTie) continue;
    any = true;
    table.Row({Escaped(point.name), std::string(survey::Name(point.role)),
               Escaped(point.description) + (point.reason.empty() ? "" : " <i>" + Escaped(point.reason) + "</i>"),
               Fixed(point.position_in_site.x(), 3), Fixed(point.position_in_site.y(), 3),
               Millimetres(std::sqrt(point.covariance(0, 0))), Millimetres(std::sqrt(point.covariance(1, 1)))});
  }
  return any ? H2("Control list") + ControlNetworkText(c) + table.Text() : "";
}

}  // namespace formats
