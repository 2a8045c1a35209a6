// SPDX-License-Identifier: Apache-2.0
#include "formats/site_vectors.h"

#include <algorithm>
#include <cmath>

#include "formats/svg.h"
#include "survey/stats/error_ellipse.h"

namespace formats {
namespace {

using survey::Certificate;
using survey::TestedCheck;

constexpr double kLongestShare = 0.05;  // of the site's extent, for the longest vector
constexpr int kEllipseVertices = 48;

const char* Text(survey::CheckKind kind) { return kind == survey::CheckKind::kPoint ? "point" : "feature"; }

double Extent(const Certificate& c) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e12), high = -low;
  const auto hold = [&](const Eigen::Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const survey::ControlPoint& point : c.points) hold(point.position_in_site);
  for (const TestedCheck& check : c.checks) hold(check.reference);
  return std::max(1.0, (high - low).maxCoeff());
}

// The same for all vectors and ellipses, so that they compare.
double Enlargement(const Certificate& c) {
  double longest = 1e-4;
  for (const TestedCheck& check : c.checks) longest = std::max(longest, check.error.norm());
  for (const survey::FitResidual& fit : c.fit) longest = std::max(longest, fit.residual.norm());
  return std::max(1.0, RoundDown(kLongestShare * Extent(c) / longest));
}

VectorFeature Arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& error, double enlargement,
                    std::vector<std::variant<double, std::string>> values) {
  for (const double each : {1000 * error.x(), 1000 * error.y(), enlargement}) values.emplace_back(each);
  return {{from, from + enlargement * error}, std::move(values)};
}

VectorFeature Ellipse(const std::string& name, const std::string& kind, const Eigen::Vector2d& centre,
                      const Eigen::Matrix2d& covariance, double enlargement) {
  const survey::ErrorEllipse standard = survey::EllipseOf(covariance);
  const double semi_major = survey::kEllipse95 * standard.semi_major;
  const double semi_minor = survey::kEllipse95 * standard.semi_minor;
  const Eigen::Vector2d major(std::sin(standard.azimuth), std::cos(standard.azimuth));
  const Eigen::Vector2d minor(-major.y(), major.x());
  VectorFeature ellipse;
  for (int i = 0; i < kEllipseVertices; ++i) {
    const double t = 2.0 * M_PI * i / kEllipseVertices;
    ellipse.vertices.emplace_back(centre +
                                  enlargement * (std::cos(t) * semi_major * major + std::sin(t) * semi_minor * minor));
  }
  ellipse.values = {name, kind, 1000 * semi_major, 1000 * semi_minor, standard.azimuth * 180.0 / M_PI, enlargement};
  return ellipse;
}

VectorLayer Control(const Certificate& c) {
  VectorLayer layer{.name = "control", .colour = "#1f5fa8", .symbol = "triangle", .label_field = "name"};
  layer.fields = {{"name", true}, {"role", true}, {"description", true}, {"sigma_e_mm"}, {"sigma_n_mm"}};
  for (const survey::ControlPoint& point : c.points) {
    if (point.role == survey::PointRole::kTie) continue;
    layer.features.push_back({{point.position_in_site},
                              {point.name, std::string(Name(point.role)), point.description,
                               1000 * std::sqrt(point.covariance(0, 0)), 1000 * std::sqrt(point.covariance(1, 1))}});
  }
  return layer;
}

VectorLayer Checks(const Certificate& c) {
  VectorLayer layer{.name = "checks", .colour = kCheckColour, .symbol = "circle", .label_field = "name"};
  layer.fields = {{"name", true}, {"kind", true}, {"block", true},  {"de_mm"},
                  {"dn_mm"},      {"d_mm"},       {"to_control_m"}, {"blunder", true}};
  for (const TestedCheck& check : c.checks) {
    layer.features.push_back(
        {{check.reference},
         {check.name, Text(check.kind), check.block, 1000 * check.error.x(), 1000 * check.error.y(),
          1000 * check.error.norm(), check.distance_to_control.value_or(-1.0), check.blunder ? "yes" : "no"}});
  }
  return layer;
}

VectorLayer ResidualVectors(const Certificate& c, double enlargement) {
  VectorLayer layer{.name = "residual_vectors", .shape = VectorShape::kLine, .colour = kCheckColour};
  layer.fields = {{"name", true}, {"block", true}, {"evidence", true}, {"de_mm"}, {"dn_mm"}, {"enlargement"}};
  for (const TestedCheck& check : c.checks) {
    layer.features.push_back(Arrow(check.reference, check.error, enlargement, {check.name, check.block, "tested"}));
  }
  for (const survey::FitResidual& fit : c.fit) {
    layer.features.push_back(Arrow(fit.given, fit.residual, enlargement, {fit.point, fit.block, "fit"}));
  }
  return layer;
}

VectorLayer Ellipses(const Certificate& c, double enlargement) {
  VectorLayer layer{.name = "ellipses", .shape = VectorShape::kPolygon, .colour = "#6a6f78"};
  layer.fields = {{"name", true}, {"kind", true}, {"major_mm"}, {"minor_mm"}, {"bearing_deg"}, {"enlargement"}};
  for (const survey::ControlPoint& point : c.points) {
    if (point.role == survey::PointRole::kTie) continue;
    layer.features.push_back(
        Ellipse(point.name, std::string(Name(point.role)), point.position_in_site, point.covariance, enlargement));
  }
  for (const TestedCheck& check : c.checks) {
    if (check.kind == survey::CheckKind::kPoint) continue;  // drawn with the control list
    layer.features.push_back(Ellipse(check.name, "feature", check.reference, check.reference_covariance, enlargement));
  }
  return layer;
}

VectorLayer Trajectories(const std::vector<BlockTrajectory>& trajectories) {
  VectorLayer layer{.name = "trajectories", .shape = VectorShape::kLine, .colour = "#7a9e3a", .label_field = "block"};
  layer.fields = {{"block", true}, {"length_m"}};
  for (const BlockTrajectory& trajectory : trajectories) {
    const std::vector<Eigen::Vector2d>& path = trajectory.positions_in_site;
    if (path.size() < 2) continue;
    double length = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
    layer.features.push_back({path, {trajectory.block, length}});
  }
  return layer;
}

VectorLayer Seams(const Certificate& c, double enlargement) {
  VectorLayer layer{.name = "seams", .shape = VectorShape::kLine, .colour = "#d9912f"};
  layer.fields = {{"feature", true}, {"block_a", true}, {"block_b", true}, {"de_mm"}, {"dn_mm"}, {"enlargement"}};
  for (const survey::StitchingPair& pair : c.stitching.pairs) {
    const auto check = std::find_if(c.checks.begin(), c.checks.end(), [&](const TestedCheck& each) {
      return each.name == pair.feature && each.block == pair.block_b;
    });
    if (check == c.checks.end()) continue;
    layer.features.push_back(
        Arrow(check->in_map, pair.difference, enlargement, {pair.feature, pair.block_a, pair.block_b}));
  }
  return layer;
}

}  // namespace

std::vector<VectorLayer> SiteVectorLayers(const Certificate& certificate,
                                          const std::vector<BlockTrajectory>& trajectories) {
  const double enlargement = Enlargement(certificate);
  return {Trajectories(trajectories),
          Ellipses(certificate, enlargement),
          ResidualVectors(certificate, enlargement),
          Seams(certificate, enlargement),
          Control(certificate),
          Checks(certificate)};
}

}  // namespace formats
