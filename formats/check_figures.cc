// SPDX-License-Identifier: Apache-2.0
#include "formats/check_figures.h"

#include <algorithm>
#include <cmath>

#include "formats/html.h"
#include "formats/svg.h"
#include "survey/accuracy/distributions.h"

namespace formats {
namespace {

using survey::Certificate;
using survey::CheckKind;
using survey::TestedCheck;

constexpr double kWidth = 340.0;  // px
constexpr double kHeight = 250.0;
constexpr double kLeft = 44.0;
constexpr double kBottom = 32.0;
constexpr const char* kAxisStyle = "stroke=\"#888\"";
constexpr const char* kGridStyle = "stroke=\"#e4e4e4\"";
constexpr const char* kNorthColour = "#1f5fa8";

// A diagram with linear axes; `low` and `high` are its corners in the values' units.
struct Diagram {
  Eigen::Vector2d low, high;

  Eigen::Vector2d operator()(const Eigen::Vector2d& value) const {
    const Eigen::Vector2d share = (value - low).cwiseQuotient(high - low);
    return {kLeft + share.x() * (kWidth - kLeft - 8), kHeight - kBottom - share.y() * (kHeight - kBottom - 8)};
  }
};

// Grid lines at round values with their numbers, the values times `unit`.
std::string Grid(const Diagram& diagram, const Eigen::Vector2d& unit) {
  std::string svg;
  for (const int axis : {0, 1}) {
    const double step = RoundDown((diagram.high[axis] - diagram.low[axis]) / 4.0);
    for (double k = std::ceil(diagram.low[axis] / step - 1e-9); k * step <= diagram.high[axis] * (1 + 1e-9); k += 1.0) {
      Eigen::Vector2d a = diagram.low, b = diagram.high;
      a[axis] = b[axis] = k * step;
      svg += Line(diagram(a), diagram(b), kGridStyle);
      const double shown = k * step * unit[axis];
      const std::string text = Fixed(shown, step * unit[axis] < 1.0 ? 1 : 0);
      svg += axis == 0 ? Label(diagram(a) + Eigen::Vector2d(0, 13), text, "text-anchor=\"middle\"")
                       : Label(diagram(a) + Eigen::Vector2d(-5, 4), text, "text-anchor=\"end\"");
    }
  }
  return svg + Line(diagram(diagram.low), diagram({diagram.high.x(), diagram.low.y()}), kAxisStyle) +
         Line(diagram(diagram.low), diagram({diagram.low.x(), diagram.high.y()}), kAxisStyle);
}

std::string AxisNames(const std::string& x, const std::string& y) {
  return Label({kWidth - 8, kHeight - 4}, x, "text-anchor=\"end\"") + Label({kLeft + 5, 14}, y, "class=\"halo\"");
}

std::vector<double> Standardised(const Certificate& certificate, CheckKind kind, int axis) {
  std::vector<double> values;
  for (const TestedCheck& check : certificate.checks) {
    if (check.kind == kind) values.push_back(check.error[axis]);
  }
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double sigma = std::sqrt(squares / static_cast<double>(values.size() - 1));
  for (double& value : values) value = sigma > 0.0 ? (value - mean) / sigma : 0.0;
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

std::string QuantilePlotSvg(const Certificate& certificate, CheckKind kind) {
  const std::vector<double> east = Standardised(certificate, kind, 0), north = Standardised(certificate, kind, 1);
  const auto n = static_cast<double>(east.size());
  double reach = 2.5;
  for (const std::vector<double>* values : {&east, &north}) {
    for (const double value : *values) reach = std::max(reach, std::abs(value) * 1.05);
  }
  const Diagram diagram{{-2.8, -reach}, {2.8, reach}};
  const double diagonal = std::min(2.8, reach);
  std::string svg = BeginSvg({kWidth, kHeight}) + Grid(diagram, {1, 1}) +
                    Line(diagram({-diagonal, -diagonal}), diagram({diagonal, diagonal}), "stroke=\"#2c7a2c\"");
  for (std::size_t i = 0; i < east.size(); ++i) {
    const double quantile =
        std::clamp(survey::NormalQuantile((static_cast<double>(i) + 0.625) / (n + 0.25)), -2.8, 2.8);
    svg += Circle(diagram({quantile, east[i]}), 2.6, std::string("fill=\"white\" stroke=\"") + kCheckColour + "\"");
    svg += Triangle(diagram({quantile, north[i]}), 3.2, std::string("fill=\"") + kNorthColour + "\"");
  }
  return svg + AxisNames("normal quantile", "error / sigma: circles east, triangles north") + "</svg>\n";
}

std::string ControlDistanceSvg(const Certificate& certificate) {
  Eigen::Vector2d reach(1.0, std::max(0.001, certificate.class_m.value_or(0.0)));
  for (const TestedCheck& check : certificate.checks) {
    if (check.distance_to_control)
      reach = reach.cwiseMax(Eigen::Vector2d(*check.distance_to_control, check.error.norm()));
  }
  const Diagram diagram{Eigen::Vector2d::Zero(), 1.05 * reach};
  std::string svg = BeginSvg({kWidth, kHeight}) + Grid(diagram, {1, 1000});
  if (certificate.class_m) {
    svg += Line(diagram({0, *certificate.class_m}), diagram({diagram.high.x(), *certificate.class_m}),
                "stroke=\"#2c7a2c\" stroke-width=\"1.6\" stroke-dasharray=\"6 3\"");
  }
  for (const TestedCheck& check : certificate.checks) {
    if (!check.distance_to_control) continue;
    svg += CheckSymbol(check.kind, diagram({*check.distance_to_control, check.error.norm()}), check.blunder);
  }
  return svg + AxisNames("to the nearest control used (m)", "error (mm)") + "</svg>\n";
}

}  // namespace formats
