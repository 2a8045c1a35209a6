// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_analysis.h"

#include "formats/check_figures.h"
#include "formats/html.h"

namespace formats {
namespace {

using survey::Certificate;
using survey::CheckAnalysis;
using survey::CheckKind;
using survey::ClassResult;

constexpr int kFewestForPlot = 3;

// What the statement was tested on: features where there are any.
bool OnFeatures(const Certificate& c) { return c.features_test.statistics.num_points > 0; }

std::string YesNo(bool yes) { return yes ? "yes" : "no"; }

std::string StatisticText(survey::ClassStatistic statistic) {
  switch (statistic) {
    case survey::ClassStatistic::kRmseHorizontal:
      return "RMSE<sub>H</sub> = &radic;(H1&sup2; + H2&sup2;)";
    case survey::ClassStatistic::kRmseAxis:
      return "larger of RMSE<sub>E</sub>, RMSE<sub>N</sub>";
    case survey::ClassStatistic::kCircle95:
      return "CE95, exact";
    case survey::ClassStatistic::kNssda95:
      return "1.7308 RMSE<sub>H1</sub>";
  }
  return "";
}

// The tests of one kind of check as cells of a column.
class AnalysisTable {
 public:
  explicit AnalysisTable(const Certificate& c) : features_(c.features_analysis), points_(c.points_analysis) {}

  std::string Text() {
    Row("Shapiro&ndash;Wilk W (p), east", [](const CheckAnalysis& a) { return Axis(a, 0); });
    Row("Shapiro&ndash;Wilk W (p), north", [](const CheckAnalysis& a) { return Axis(a, 1); });
    Row("Mardia skewness (p) / kurtosis (p)", [](const CheckAnalysis& a) {
      return !a.normality ? std::string(kDash)
                          : WithP(a.normality->skewness, a.normality->skewness_p) + " / " +
                                WithP(a.normality->kurtosis, a.normality->kurtosis_p);
    });
    Row("outliers among the errors (Rosner, Wilks)",
        [](const CheckAnalysis& a) { return std::to_string(a.num_outliers); });
    Row("blocks differ: Wilks' &Lambda; (p)", [](const CheckAnalysis& a) {
      return a.block_effect ? WithP(a.block_effect->wilks_lambda, a.block_effect->p_value) : std::string(kDash);
    });
    Row("neighbours agree: Moran's I (p)",
        [](const CheckAnalysis& a) { return a.moran ? WithP(a.moran->i, a.moran->p_value) : std::string(kDash); });
    Row("hull of the checks / of the path", [](const CheckAnalysis& a) {
      return a.spread ? Fixed(100 * a.spread->hull_share, 0) + " %" : std::string(kDash);
    });
    Row("checks in NE, NW, SW, SE", [](const CheckAnalysis& a) { return Quadrants(a); });
    Row("to the nearest control: least, median, most (m)", [](const CheckAnalysis& a) {
      return a.spread ? Fixed(a.spread->nearest_control_min, 1) + ", " + Fixed(a.spread->nearest_control_median, 1) +
                            ", " + Fixed(a.spread->nearest_control_max, 1)
                      : std::string(kDash);
    });
    return table_.Text();
  }

 private:
  static std::string WithP(double value, double p) { return Fixed(value, 3) + " (" + Fixed(p, 3) + ")"; }
  static std::string Axis(const CheckAnalysis& a, int axis) {
    return a.normality ? WithP(a.normality->w[axis], a.normality->p_by_axis[axis]) : std::string(kDash);
  }
  static std::string Quadrants(const CheckAnalysis& a) {
    if (!a.spread) return kDash;
    std::string text;
    for (const double share : a.spread->quadrant_shares) text += (text.empty() ? "" : ", ") + Fixed(100 * share, 0);
    return text + " %";
  }
  template <typename Cell>
  void Row(const std::string& name, Cell cell) {
    table_.Row({name, cell(features_), cell(points_)});
  }

  const CheckAnalysis& features_;
  const CheckAnalysis& points_;
  HtmlTable table_{{"test", "check features", "check points"}, 1};
};

std::string Drawings(const Certificate& c) {
  const bool on_features = OnFeatures(c);
  const survey::ErrorStatistics& statistics = on_features ? c.features_test.statistics : c.points_test.statistics;
  std::string html = "<div class=\"two\">";
  if (statistics.num_errors >= kFewestForPlot) {
    const CheckKind kind = on_features ? CheckKind::kFeature : CheckKind::kPoint;
    html += Figure(QuantilePlotSvg(c, kind), std::string("Q&ndash;Q plot of the errors of the check ") +
                                                 (on_features ? "features" : "points") +
                                                 "; normal errors lie on the line.");
  }
  return html + Figure(ControlDistanceSvg(c), "Errors against the distance to control. Dashed: the class.") +
         "</div>\n";
}

}  // namespace

std::string ClassesSection(const Certificate& c) {
  const std::vector<ClassResult>& classes = OnFeatures(c) ? c.features_analysis.classes : c.points_analysis.classes;
  if (classes.empty()) return "";
  HtmlTable table({"standard", "class", "statistic", "level", "source", "limit (mm)", "found (mm)", "95 % bound (mm)",
                   "meets", "demonstrated"},
                  5);
  for (const ClassResult& each : classes) {
    const survey::AccuracyClass& k = each.accuracy_class;
    table.Row({Escaped(k.standard), Escaped(k.name), StatisticText(k.statistic),
               Fixed(100 * k.confidence, 0) + "&nbsp;%", Escaped(k.source), Millimetres(k.limit_m),
               Millimetres(each.value_m), each.upper_95 ? Millimetres(*each.upper_95) : kDash, YesNo(each.meets),
               each.demonstrated ? "<b>yes</b>" : "no"});
  }
  return H2("Classes of standards and contracts") + "<div class=\"small\">" + table.Text() + "</div>" +
         P(std::string("Judged on the check ") + (OnFeatures(c) ? "features" : "points") +
               ". Level: share of errors that the limit is meant to hold; limits of different levels do not compare. "
               "Demonstrated: the one-sided 95 % bound is within the limit.",
           "note");
}

std::string AnalysisSection(const Certificate& c) {
  if (c.checks.empty()) return "";
  return H2("Behaviour of the errors") + Drawings(c) + AnalysisTable(c).Text() +
         P("p: probability of such a value without the effect; below 0.05 it counts. Where blocks differ, the bounds "
           "rest on blocks instead of checks.",
           "note");
}

}  // namespace formats
