// SPDX-License-Identifier: Apache-2.0
#include "formats/control_source.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "formats/adjusted_gama.h"
#include "formats/control_landxml.h"
#include "formats/crs_area.h"
#include "formats/csv.h"
#include "formats/errors.h"
#include "formats/text_numbers.h"
#include "formats/xml_stream.h"
#include "survey/accuracy/distributions.h"

namespace formats {
namespace {

namespace fs = std::filesystem;
using survey::ControlPoint;

std::string Extension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

// The name of an XML file's root element, read no further.
std::string RootElement(const fs::path& file) {
  struct Found {
    std::string name;
  };
  std::vector<std::string> warnings;
  try {
    ReadXml(file, {.start = [](XmlElement& element) { throw Found{element.name()}; }}, &warnings);
  } catch (const Found& found) {
    return found.name;
  }
  return "";
}

Eigen::Matrix2d Isotropic(double sigma_m) { return Eigen::Matrix2d::Identity() * sigma_m * sigma_m; }

ControlSource FromCsv(const fs::path& file, const ControlSourceOptions& options) {
  ControlCsv csv = ReadControlCsv(file, options.csv);
  ControlSource source{.num_default_sigmas = csv.num_default_sigmas, .warnings = std::move(csv.warnings)};
  source.control.points = std::move(csv.points);
  return source;
}

ControlSource FromLandXml(const fs::path& file, const ControlSourceOptions& options) {
  LandXmlFile landxml = ReadLandXml(file);
  const std::string stated = landxml.epsg_code.empty() ? "" : "EPSG:" + landxml.epsg_code;
  if (!stated.empty() && options.csv.crs.starts_with("EPSG:") && options.csv.crs != stated) {
    throw DataError(file.string() + ": its coordinates are in " + stated + ", the site is in " + options.csv.crs);
  }
  ControlSource source{.num_default_sigmas = static_cast<int>(landxml.points.size()),
                       .warnings = std::move(landxml.warnings)};
  std::vector<std::string> where;
  for (const LandXmlPoint& point : landxml.points) {
    source.control.points.push_back({.name = point.name,
                                     .position_in_site = point.east_north,
                                     .covariance = Isotropic(options.csv.default_sigma_m),
                                     .elevation_m = point.elevation_m,
                                     .description = point.description});
    where.push_back(file.string() + ": ");
  }
  CheckControlArea(source.control.points, options.csv.crs, where, &source.warnings);
  return source;
}

survey::AdjustmentSummary SummaryOf(const AdjustedNetworkFile& adjusted) {
  survey::AdjustmentSummary summary{.software = adjusted.software,
                                    .description = adjusted.description,
                                    .num_observations = adjusted.num_observations,
                                    .num_unknowns = adjusted.num_unknowns,
                                    .defect = adjusted.defect,
                                    .degrees_of_freedom = adjusted.degrees_of_freedom,
                                    .sigma_zero_a_priori = adjusted.sigma_zero_a_priori,
                                    .sigma_zero = adjusted.sigma_zero_a_posteriori,
                                    .confidence = adjusted.confidence};
  summary.scaled = adjusted.sigma_used_is_a_posteriori;
  if (summary.degrees_of_freedom == 0) return summary;
  const double ratio = summary.sigma_zero / summary.sigma_zero_a_priori, tail = (1.0 - summary.confidence) / 2.0;
  summary.chi_square = ratio * ratio * summary.degrees_of_freedom;
  summary.chi_square_lower = survey::ChiSquareQuantile(tail, summary.degrees_of_freedom);
  summary.chi_square_upper = survey::ChiSquareQuantile(1.0 - tail, summary.degrees_of_freedom);
  return summary;
}

ControlSource FromGamaAdjustment(const fs::path& file, const ControlSourceOptions& options) {
  AdjustedNetworkFile adjusted = ReadGamaAdjustment(file);
  ControlSource source{.warnings = std::move(adjusted.warnings)};
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < adjusted.points.size(); ++i) {
    if (adjusted.points[i].has_plane) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return adjusted.points[a].name < adjusted.points[b].name; });
  const auto row = [](std::size_t point) { return static_cast<Eigen::Index>(3 * point); };
  std::vector<std::string> where;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const AdjustedPoint& point = adjusted.points[order[a]];
    if (a > 0 && adjusted.points[order[a - 1]].name == point.name) {
      throw DataError(file.string() + ": point " + point.name + " is there twice");
    }
    ControlPoint control{.name = point.name, .position_in_site = point.position.head<2>()};
    if (point.has_height) control.elevation_m = point.position.z();
    if (point.fixed) {
      control.covariance = Isotropic(options.csv.default_sigma_m);
      ++source.num_default_sigmas;
    } else {
      control.covariance = adjusted.covariance.block<2, 2>(row(order[a]), row(order[a]));
      const double height_variance = adjusted.covariance(row(order[a]) + 2, row(order[a]) + 2);
      if (point.has_height) control.elevation_sigma_m = std::sqrt(height_variance);
    }
    source.control.points.push_back(control);
    where.push_back(file.string() + ": ");
    for (std::size_t b = 0; b < a; ++b) {
      const Eigen::Matrix2d block = adjusted.covariance.block<2, 2>(row(order[b]), row(order[a]));
      if (!block.isZero(0.0)) {
        source.control.correlations.push_back({static_cast<int>(b), static_cast<int>(a), block});
      }
    }
  }
  std::sort(source.control.correlations.begin(), source.control.correlations.end(),
            [](const auto& x, const auto& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  source.control.adjustment = SummaryOf(adjusted);
  CheckControlArea(source.control.points, options.csv.crs, where, &source.warnings);
  return source;
}

ControlSource FromNetwork(NetworkFile file) {
  ControlSource source{.warnings = std::move(file.warnings)};
  source.network = std::move(file);
  return source;
}

ControlSource FromXml(const fs::path& file, const ControlSourceOptions& options) {
  const std::string root = RootElement(file);
  if (root == "LandXML") return FromLandXml(file, options);
  if (root == "gama-local-adjustment") return FromGamaAdjustment(file, options);
  if (root == "gama-local" || root == "gama-xml") return FromNetwork(ReadGkf(file));
  throw DataError(file.string() + ": <" + root +
                  "> is not control; known are LandXML, GNU Gama's adjustment and GNU Gama's network");
}

}  // namespace

bool IsControlSource(const fs::path& file) {
  const std::string extension = Extension(file);
  for (const char* known : {".csv", ".txt", ".gkf", ".dat", ".xml"}) {
    if (extension == known) return true;
  }
  return false;
}

bool IsPointList(const fs::path& file) {
  const std::string extension = Extension(file);
  return extension == ".csv" || extension == ".txt";
}

ControlSource ReadControlSource(const fs::path& file, const ControlSourceOptions& options) {
  const std::string extension = Extension(file);
  if (extension == ".gkf") return FromNetwork(ReadGkf(file));
  if (extension == ".dat") return FromNetwork(ReadStarnet(file, options.starnet));
  if (extension == ".xml") return FromXml(file, options);
  if (IsPointList(file)) return FromCsv(file, options);
  throw DataError(file.string() + ": control must be a .csv, .txt, .gkf, .dat or .xml file");
}

std::vector<PointRoleRow> ReadRolesCsv(const fs::path& file) {
  CsvReader csv(file);
  csv.ReadHeader({"point", "role", "reason"});
  std::vector<PointRoleRow> rows;
  std::set<std::string> names;
  while (csv.NextRow()) {
    PointRoleRow row{.point = std::string(csv.Text(0)),
                     .reason = std::string(csv.fields()[2]),
                     .where = file.string() + ":" + std::to_string(csv.row())};
    const std::string_view text = csv.Text(1);
    bool known = false;
    for (const survey::PointRole role : {survey::PointRole::kControl, survey::PointRole::kCheck,
                                         survey::PointRole::kTie, survey::PointRole::kExcluded}) {
      if (text != survey::Name(role)) continue;
      row.role = role;
      known = true;
    }
    if (!known) csv.Fail(1, "must be control, check, tie or excluded");
    if (row.role == survey::PointRole::kExcluded && row.reason.empty()) csv.Fail(2, "an excluded point needs a reason");
    if (!names.insert(row.point).second) csv.Fail(0, "is there twice: a point has one role");
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace formats
