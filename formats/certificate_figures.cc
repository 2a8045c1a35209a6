// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_figures.h"

#include <algorithm>
#include <cmath>

#include "formats/html.h"
#include "formats/svg.h"
#include "survey/stats/error_ellipse.h"

namespace formats {
namespace {

using survey::Certificate;
using survey::CheckKind;
using survey::TestedCheck;

constexpr double kMapWidth = 700.0;  // px
constexpr double kMaxMapHeight = 560.0;
constexpr double kLegendHeight = 62.0;
constexpr double kScatterSize = 330.0;
constexpr const char* kControlColour = "#1f5fa8";
constexpr const char* kTrackColours[] = {"#7a9e3a", "#b07cc6", "#d9912f", "#3aa6a0", "#8a8a8a", "#c45f8a"};

std::string ArrowTo(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const std::string& colour) {
  const std::string style = "stroke=\"" + colour + "\" stroke-width=\"1.4\"";
  std::string arrow = Line(from, to, style);
  const Eigen::Vector2d along = to - from;
  if (along.norm() < 5.0) return arrow;
  const Eigen::Vector2d back = -along.normalized() * 4.5;
  const Eigen::Vector2d side(-back.y(), back.x());
  return arrow + Line(to, to + back + 0.5 * side, style) + Line(to, to + back - 0.5 * side, style);
}

// Site coordinates to the drawing's pixels.
struct View {
  Eigen::Vector2d south_west;
  Eigen::Vector2d extent;
  double pixels_per_m = 1.0;

  Eigen::Vector2d operator()(const Eigen::Vector2d& p) const {
    return {(p.x() - south_west.x()) * pixels_per_m, (south_west.y() + extent.y() - p.y()) * pixels_per_m};
  }
  Eigen::Vector2d Size() const { return extent * pixels_per_m; }
};

View ViewOf(const CertificatePage& page) {
  std::vector<Eigen::Vector2d> points;
  if (page.map) points = {page.map->south_west, page.map->south_west + page.map->extent_m};
  for (const TestedCheck& check : page.certificate.checks) points.push_back(check.reference);
  for (const survey::FitResidual& fit : page.certificate.fit) points.push_back(fit.given);
  for (const BlockTrajectory& trajectory : page.trajectories) {
    points.insert(points.end(), trajectory.positions_in_site.begin(), trajectory.positions_in_site.end());
  }
  if (points.empty()) points = {{0, 0}, {10, 10}};
  Eigen::Vector2d low = points.front(), high = points.front();
  for (const Eigen::Vector2d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.02 * (high - low).maxCoeff() + 0.5);
  View view{.south_west = low - margin, .extent = high - low + 2 * margin};
  view.pixels_per_m = std::min(kMapWidth / view.extent.x(), kMaxMapHeight / view.extent.y());
  return view;
}

std::string Picture(const MapThumbnail& map, const View& view) {
  const Eigen::Vector2d corner = view(map.south_west + Eigen::Vector2d(0, map.extent_m.y()));
  return "<image x=\"" + Px(corner.x()) + "\" y=\"" + Px(corner.y()) + "\" width=\"" +
         Px(map.extent_m.x() * view.pixels_per_m) + "\" height=\"" + Px(map.extent_m.y() * view.pixels_per_m) +
         "\" preserveAspectRatio=\"none\" href=\"data:image/png;base64," + Base64(map.png) + "\"/>\n";
}

std::string TrackColour(std::size_t index) { return kTrackColours[index % std::size(kTrackColours)]; }

// Points closer than a pixel to the last one drawn are left out.
std::string Track(const BlockTrajectory& trajectory, const View& view, const std::string& colour) {
  std::string points;
  Eigen::Vector2d last(-1e9, -1e9);
  for (const Eigen::Vector2d& p : trajectory.positions_in_site) {
    const Eigen::Vector2d at = view(p);
    if ((at - last).norm() < 1.0) continue;
    last = at;
    points += Px(at.x()) + "," + Px(at.y()) + " ";
  }
  return "<polyline fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"1\" points=\"" + points + "\"/>\n";
}

double LongestVector(const Certificate& certificate) {
  double longest = 0.0;
  for (const TestedCheck& check : certificate.checks) longest = std::max(longest, check.error.norm());
  for (const survey::FitResidual& fit : certificate.fit) longest = std::max(longest, fit.residual.norm());
  return longest;
}

std::string Vectors(const Certificate& certificate, const View& view, double enlargement) {
  std::string svg;
  for (const survey::FitResidual& fit : certificate.fit) {
    svg += ArrowTo(view(fit.given), view(fit.given + enlargement * fit.residual), kControlColour);
  }
  for (const TestedCheck& check : certificate.checks) {
    svg += ArrowTo(view(check.reference), view(check.reference + enlargement * check.error), kCheckColour);
  }
  return svg;
}

std::string Symbols(const Certificate& certificate, const View& view) {
  std::string svg;
  std::vector<std::string> named;
  const Eigen::Vector2d aside(5, -4);
  for (const survey::FitResidual& fit : certificate.fit) {
    if (std::find(named.begin(), named.end(), fit.point) != named.end()) continue;
    named.push_back(fit.point);
    svg += Triangle(view(fit.given), 4.6,
                    std::string("fill=\"") + kControlColour + "\" stroke=\"white\" stroke-width=\"0.6\"");
    svg += Label(view(fit.given) + aside, fit.point, std::string("class=\"halo\" fill=\"") + kControlColour + "\"");
  }
  for (const TestedCheck& check : certificate.checks) {
    svg += CheckSymbol(check.kind, view(check.reference), check.blunder);
    if (check.kind == CheckKind::kPoint && std::find(named.begin(), named.end(), check.name) == named.end()) {
      named.push_back(check.name);
      svg +=
          Label(view(check.reference) + aside, check.name, std::string("class=\"halo\" fill=\"") + kCheckColour + "\"");
    }
  }
  return svg;
}

std::string NorthArrow(const Eigen::Vector2d& at) {
  return "<path d=\"M" + Px(at.x()) + " " + Px(at.y()) + " l5 18 l-5 -4 l-5 4 Z\" fill=\"#222\" stroke=\"white\"/>" +
         Label(at + Eigen::Vector2d(0, 29), "N", "text-anchor=\"middle\" class=\"halo\"");
}

std::string SymbolLegend(double y) {
  return Triangle({12, y}, 5, std::string("fill=\"") + kControlColour + "\"") +
         Label({22, y + 4}, "control used, residual") + CheckSymbol(CheckKind::kPoint, {162, y}, false) +
         Label({171, y + 4}, "check point, error") + CheckSymbol(CheckKind::kFeature, {288, y}, false) +
         Label({297, y + 4}, "check feature, error");
}

std::string Legend(const CertificatePage& page, const View& view, double enlargement, double vector_m) {
  const double y = view.Size().y() + 16;
  const bool tied = page.certificate.tied;
  std::string svg = tied ? SymbolLegend(y) : "";
  double x = tied ? 430 : 8;
  for (std::size_t i = 0; i < page.trajectories.size() && x < 640; ++i) {
    svg += Line({x, y}, {x + 14, y}, "stroke=\"" + TrackColour(i) + "\" stroke-width=\"2\"");
    svg += Label({x + 18, y + 4}, page.trajectories[i].block);
    x += 34 + 7.0 * static_cast<double>(page.trajectories[i].block.size());
  }
  const double map_bar_m = RoundDown(120.0 / view.pixels_per_m);
  svg += ScaleBar({8, y + 28}, map_bar_m * view.pixels_per_m, LengthText(map_bar_m) + " map", "#222");
  if (vector_m > 0.0) {
    svg += ScaleBar({290, y + 28}, vector_m * enlargement * view.pixels_per_m,
                    LengthText(vector_m) + " vectors (enlarged " + Fixed(enlargement, 0) + " times)", kCheckColour);
  }
  return svg;
}

// Holds 95 % of a normal error; covariance in pixels, north up.
std::string Ellipse95(const Eigen::Vector2d& centre, const Eigen::Matrix2d& covariance) {
  const survey::ErrorEllipse ellipse = survey::EllipseOf(covariance);
  const double turn_deg = ellipse.azimuth * 180.0 / M_PI - 90.0;
  return "<ellipse rx=\"" + Px(survey::kEllipse95 * ellipse.semi_major) + "\" ry=\"" +
         Px(survey::kEllipse95 * ellipse.semi_minor) + "\" transform=\"translate(" + Px(centre.x()) + " " +
         Px(centre.y()) + ") rotate(" + Px(turn_deg) + ")\" fill=\"none\" stroke=\"" + kCheckColour +
         "\" stroke-dasharray=\"3 2\"/>\n";
}

}  // namespace

std::string ResidualMapSvg(const CertificatePage& page) {
  const View view = ViewOf(page);
  const Eigen::Vector2d size = view.Size();
  const double longest = LongestVector(page.certificate);
  const double enlargement = longest > 0.0 ? std::max(1.0, RoundDown(70.0 / (longest * view.pixels_per_m))) : 1.0;
  std::string svg = BeginSvg({std::max(size.x(), kMapWidth), size.y() + kLegendHeight}) + "<rect width=\"" +
                    Px(size.x()) + "\" height=\"" + Px(size.y()) + "\" fill=\"#ececec\"/>\n";
  if (page.map) svg += Picture(*page.map, view);
  for (std::size_t i = 0; i < page.trajectories.size(); ++i) {
    svg += Track(page.trajectories[i], view, TrackColour(i));
  }
  svg += Vectors(page.certificate, view, enlargement) + Symbols(page.certificate, view);
  svg += "<rect width=\"" + Px(size.x()) + "\" height=\"" + Px(size.y()) + "\" fill=\"none\" stroke=\"#999\"/>\n";
  if (page.certificate.tied) svg += NorthArrow({size.x() - 16, 10});
  return svg + Legend(page, view, enlargement, longest > 0.0 ? RoundDown(longest) : 0.0) + "</svg>\n";
}

std::string ErrorScatterSvg(const Certificate& certificate) {
  const survey::ErrorStatistics& statistics = certificate.features_test.statistics.num_points > 0
                                                  ? certificate.features_test.statistics
                                                  : certificate.points_test.statistics;
  const std::optional<double> ce95 = statistics.ce95;
  const double class_m = certificate.class_m.value_or(0.0);
  double reach = std::max({0.001, class_m, ce95.value_or(0.0)});
  for (const TestedCheck& check : certificate.checks) reach = std::max(reach, check.error.norm());
  const double scale = 0.44 * kScatterSize / reach;
  const Eigen::Vector2d centre(kScatterSize / 2, kScatterSize / 2);
  const auto at = [&](const Eigen::Vector2d& error) {
    return Eigen::Vector2d(centre + scale * Eigen::Vector2d(error.x(), -error.y()));
  };
  std::string svg = BeginSvg({kScatterSize, kScatterSize + 46});
  const double grid = RoundDown(reach / 2);
  for (double x = -std::floor(reach / grid) * grid; x <= reach * 1.0001; x += grid) {
    const double from = 0.46 * kScatterSize / scale;
    svg += Line(at({x, -from}), at({x, from}), "stroke=\"#e4e4e4\"") +
           Line(at({-from, x}), at({from, x}), "stroke=\"#e4e4e4\"");
  }
  svg += Line(at({-1.05 * reach, 0}), at({1.05 * reach, 0}), "stroke=\"#888\"");
  svg += Line(at({0, -1.05 * reach}), at({0, 1.05 * reach}), "stroke=\"#888\"");
  if (class_m > 0)
    svg += Circle(centre, scale * class_m,
                  "fill=\"none\" stroke=\"#2c7a2c\" stroke-width=\"1.6\" stroke-dasharray=\"6 3\"");
  if (ce95) svg += Circle(centre, scale * *ce95, std::string("fill=\"none\" stroke=\"") + kCheckColour + "\"");
  if (statistics.covariance) svg += Ellipse95(at(statistics.mean), scale * scale * *statistics.covariance);
  for (const TestedCheck& check : certificate.checks) svg += CheckSymbol(check.kind, at(check.error), check.blunder);
  svg +=
      Label({kScatterSize - 4, centre.y() - 5}, "east", "text-anchor=\"end\"") + Label({centre.x() + 5, 11}, "north");
  const double y = kScatterSize + 12;
  if (class_m > 0) {
    svg += Line({8, y}, {34, y}, "stroke=\"#2c7a2c\" stroke-width=\"1.6\" stroke-dasharray=\"6 3\"");
    svg += Label({40, y + 4}, "class, RMSE_H " + Fixed(class_m * 100, 1) + " cm");
  }
  if (ce95) {
    svg += Line({152, y}, {172, y}, std::string("stroke=\"") + kCheckColour + "\"");
    svg += Label({177, y + 4}, "95 % circle " + Fixed(*ce95 * 100, 1) + " cm, ellipse");
  }
  return svg + ScaleBar({8, y + 20}, grid * scale, LengthText(grid) + " (grid)", "#222") + "</svg>\n";
}

}  // namespace formats
