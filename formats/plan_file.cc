// SPDX-License-Identifier: Apache-2.0
#include "formats/plan_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "formats/html.h"
#include "formats/json_text.h"

namespace formats {
namespace {

using nlohmann::json;

constexpr double kPanel = 420.0;  // side of each panel, and the space around it, in pixels
constexpr double kMargin = 60.0;

double Rounded(double metres) { return std::round(metres * 1e4) / 1e4 + 0.0; }

std::string At(double x, double y) { return Fixed(x, 1) + "," + Fixed(y, 1); }

std::string Label(double x, double y, const std::string& text, const std::string& anchor = "middle") {
  return "<text x=\"" + Fixed(x, 1) + "\" y=\"" + Fixed(y, 1) + "\" text-anchor=\"" + anchor + "\">" + Escaped(text) +
         "</text>\n";
}

std::string Circle(double x, double y, double radius, const std::string& style) {
  return "<circle cx=\"" + Fixed(x, 1) + "\" cy=\"" + Fixed(y, 1) + "\" r=\"" + Fixed(radius, 1) + "\" " + style +
         "/>\n";
}

// Accuracy (mm) against the number of points, from the second on.
std::string Curve(const PlanReport& report) {
  double top = 0.0;
  for (const PlanReport::Point& point : report.points) top = std::max(top, 1000.0 * point.max);
  if (!(top > 0.0)) return "";
  const double steps = static_cast<double>(std::max<std::size_t>(2, report.points.size()) - 1);
  const auto x_of = [&](std::size_t i) { return kMargin + kPanel * static_cast<double>(i) / steps; };
  const auto y_of = [&](double metres) { return kMargin + kPanel * (1.0 - 1000.0 * metres / top); };
  std::string rms, max, labels;
  for (std::size_t i = 0; i < report.points.size(); ++i) {
    labels += Label(x_of(i), kMargin + kPanel + 18.0, std::to_string(i + 1));
    if (i == 0 || report.points[i].rms == 0.0) continue;
    rms += At(x_of(i), y_of(report.points[i].rms)) + " ";
    max += At(x_of(i), y_of(report.points[i].max)) + " ";
    labels += Label(x_of(i), y_of(report.points[i].rms) + 16.0, Fixed(1000.0 * report.points[i].rms, 1));
  }
  return "<g><path d=\"M" + At(kMargin, kMargin) + " V" + Fixed(kMargin + kPanel, 1) + " H" +
         Fixed(kMargin + kPanel, 1) + "\" class=\"axis\"/>\n<polyline points=\"" + max +
         "\" class=\"max\"/>\n<polyline points=\"" + rms + "\" class=\"rms\"/>\n" + labels +
         Label(kMargin + kPanel / 2.0, kMargin + kPanel + 40.0, "control points") +
         Label(kMargin, kMargin - 12.0, "predicted sigma (mm): rms, largest dashed; top " + Fixed(top, 0), "start") +
         "</g>\n";
}

// From blue (best) to red (worst).
std::string Colour(double share) {
  const auto level = [](double value) { return std::to_string(std::lround(40.0 + 200.0 * value)); };
  return "rgb(" + level(share) + ",60," + level(1.0 - share) + ")";
}

// The map's panel: the way fills it.
class MapPanel {
 public:
  explicit MapPanel(const PlanReport& report) : low_(report.path.front().place), high_(low_) {
    for (const PlanReport::Place& place : report.path) {
      low_ = low_.cwiseMin(place.place);
      high_ = high_.cwiseMax(place.place);
    }
    scale_ = kPanel / std::max(1.0, size().maxCoeff());
  }
  Eigen::Vector2d size() const { return high_ - low_; }
  double X(const Eigen::Vector2d& p) const { return kLeft + scale_ * (p.x() - low_.x()); }
  double Y(const Eigen::Vector2d& p) const { return kMargin + kPanel - scale_ * (p.y() - low_.y()); }

  static constexpr double kLeft = 2.0 * kMargin + kPanel;

 private:
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  double scale_ = 1.0;
};

// What of the building lies around the way.
std::string Walls(const PlanReport& report, const MapPanel& panel) {
  std::string path;
  for (const PlanReport::Wall& wall : report.walls)
    path += "M" + At(panel.X(wall.a), panel.Y(wall.a)) + "L" + At(panel.X(wall.b), panel.Y(wall.b));
  if (path.empty()) return "";
  constexpr double kAround = kMargin / 2.0;
  return "<clipPath id=\"map\"><rect x=\"" + Fixed(MapPanel::kLeft - kAround, 1) + "\" y=\"" +
         Fixed(kMargin - kAround / 4.0, 1) + "\" width=\"" + Fixed(kPanel + 2.0 * kAround, 1) + "\" height=\"" +
         Fixed(kPanel + 2.0 * kAround, 1) + "\"/></clipPath>\n<path clip-path=\"url(#map)\" class=\"wall\" d=\"" +
         path + "\"/>\n";
}

std::string Map(const PlanReport& report) {
  if (report.path.empty()) return "";
  const MapPanel panel(report);
  const auto [least, worst] =
      std::minmax_element(report.path.begin(), report.path.end(),
                          [](const PlanReport::Place& a, const PlanReport::Place& b) { return a.sigma < b.sigma; });
  const double range = worst->sigma - least->sigma;
  std::string text = Walls(report, panel);
  for (const PlanReport::Place& place : report.path)
    text += Circle(panel.X(place.place), panel.Y(place.place), 3.0,
                   "fill=\"" + Colour(range > 0.0 ? (place.sigma - least->sigma) / range : 0.0) + "\"");
  for (const PlanReport::Point& point : report.points) {
    text += Circle(panel.X(point.place), panel.Y(point.place), 6.0, point.existing ? "class=\"old\"" : "class=\"new\"");
    text += Label(panel.X(point.place) + 9.0, panel.Y(point.place) - 7.0, point.name, "start");
  }
  return "<g>" + text +
         Label(MapPanel::kLeft, kMargin - 12.0,
               "sigma with all points (mm): blue " + Fixed(1000.0 * least->sigma, 1) + ", red " +
                   Fixed(1000.0 * worst->sigma, 1) + "; " + Fixed(panel.size().x(), 0) + " m x " +
                   Fixed(panel.size().y(), 0) + " m",
               "start") +
         "</g>\n";
}

}  // namespace

void WritePlan(const std::filesystem::path& file, const PlanReport& report, const Provenance& provenance) {
  json points = json::array();
  for (const PlanReport::Point& point : report.points) {
    const bool known = point.rms > 0.0;
    points.push_back({{"name", point.name},
                      {"existing", point.existing},
                      {"easting", Rounded(point.place.x())},
                      {"northing", Rounded(point.place.y())},
                      {"rms_m", known ? json(Rounded(point.rms)) : json()},
                      {"max_m", known ? json(Rounded(point.max)) : json()}});
  }
  json path = json::array();
  for (const PlanReport::Place& place : report.path)
    path.push_back({Rounded(place.place.x()), Rounded(place.place.y()), Rounded(place.sigma)});
  const json document = {{"format", "plumbline-plan"},
                         {"format_version", 1},
                         {"tied", report.tied},
                         {"crs", report.crs},
                         {"points", std::move(points)},
                         {"path", std::move(path)},
                         {"provenance", ToJson(provenance)}};
  WriteJson(file, document);
}

void WritePlanPicture(const std::filesystem::path& file, const PlanReport& report) {
  const std::string width = Fixed(2.0 * kPanel + 4.0 * kMargin, 0);
  const std::string height = Fixed(kPanel + 2.0 * kMargin, 0);
  WriteFileAtomically(
      file, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " + height + "\" width=\"" + width +
                "\" height=\"" + height +
                "\">\n<style>text{font:12px sans-serif} .axis{fill:none;stroke:#000} .rms{fill:none;stroke:#036;"
                "stroke-width:2} .max{fill:none;stroke:#a30;stroke-dasharray:4} .new{fill:#fff;stroke:#000;"
                "stroke-width:2} .wall{fill:none;stroke:#999} .old{fill:#888;stroke:#000;stroke-width:2}</style>\n"
                "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
                Curve(report) + Map(report) + "</svg>\n");
}

}  // namespace formats
