// SPDX-License-Identifier: Apache-2.0
#include "formats/svg.h"

#include <cmath>

#include "formats/html.h"

namespace formats {

std::string Px(double value) { return Fixed(value, 1); }

std::string BeginSvg(const Eigen::Vector2d& size) {
  return "<svg viewBox=\"0 0 " + Px(size.x()) + " " + Px(size.y()) +
         "\" role=\"img\" font-size=\"11\" font-family=\"Liberation Sans, Arial, sans-serif\">\n";
}

std::string Line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const std::string& style) {
  return "<line x1=\"" + Px(a.x()) + "\" y1=\"" + Px(a.y()) + "\" x2=\"" + Px(b.x()) + "\" y2=\"" + Px(b.y()) + "\" " +
         style + "/>\n";
}

std::string Circle(const Eigen::Vector2d& centre, double radius, const std::string& style) {
  return "<circle cx=\"" + Px(centre.x()) + "\" cy=\"" + Px(centre.y()) + "\" r=\"" + Px(radius) + "\" " + style +
         "/>\n";
}

std::string Label(const Eigen::Vector2d& at, const std::string& text, const std::string& style) {
  return "<text x=\"" + Px(at.x()) + "\" y=\"" + Px(at.y()) + "\" " + style + ">" + Escaped(text) + "</text>\n";
}

std::string Triangle(const Eigen::Vector2d& at, double r, const std::string& style) {
  return "<path d=\"M" + Px(at.x()) + " " + Px(at.y() - r) + " L" + Px(at.x() + 0.87 * r) + " " + Px(at.y() + 0.5 * r) +
         " L" + Px(at.x() - 0.87 * r) + " " + Px(at.y() + 0.5 * r) + " Z\" " + style + "/>\n";
}

std::string Square(const Eigen::Vector2d& at, double r, const std::string& style) {
  return "<rect x=\"" + Px(at.x() - r) + "\" y=\"" + Px(at.y() - r) + "\" width=\"" + Px(2 * r) + "\" height=\"" +
         Px(2 * r) + "\" " + style + "/>\n";
}

std::string CheckSymbol(survey::CheckKind kind, const Eigen::Vector2d& at, bool blunder) {
  const std::string style = std::string("fill=\"") + (blunder ? kCheckColour : "white") + "\" stroke=\"" +
                            kCheckColour + "\" stroke-width=\"1.2\"";
  return kind == survey::CheckKind::kPoint ? Circle(at, 3.6, style) : Square(at, 3.0, style);
}

double RoundDown(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= value * (1 + 1e-9)) return step * power;
  }
  return power;
}

std::string LengthText(double metres) {
  if (metres < 0.01) return Fixed(metres * 1000, metres < 0.001 ? 1 : 0) + " mm";
  if (metres < 1) return Fixed(metres * 100, 0) + " cm";
  return Fixed(metres, 0) + " m";
}

std::string ScaleBar(const Eigen::Vector2d& at, double length, const std::string& text, const std::string& colour) {
  const std::string style = "stroke=\"" + colour + "\" stroke-width=\"1.6\"";
  const Eigen::Vector2d end = at + Eigen::Vector2d(length, 0), tick(0, 4);
  return Line(at, end, style) + Line(at - tick, at + tick, style) + Line(end - tick, end + tick, style) +
         Label(end + Eigen::Vector2d(7, 4), text);
}

}  // namespace formats
