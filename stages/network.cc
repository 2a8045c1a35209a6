// SPDX-License-Identifier: Apache-2.0
//
// Reads the control, adjusts it where it is observations, checks the blocks' marks against it and writes control.sqlite
// with all points, and for each block the extract that its adjustment may see. An extract's provenance depends on its
// own points alone, so that a change of another point leaves it as it is.
#include <algorithm>
#include <cstdio>
#include <set>

#include "formats/artefacts.h"
#include "formats/control_source.h"
#include "formats/crs_area.h"
#include "formats/digest.h"
#include "formats/field_csv.h"
#include "formats/grid_scale.h"
#include "formats/raster_file.h"
#include "formats/tie_csv.h"
#include "pipeline/stage.h"
#include "survey/control/block_extract.h"
#include "survey/control/coordinate_reduction.h"
#include "survey/network/control_of_network.h"

namespace {

using formats::DataError;
using pipeline::Content;
using pipeline::NamedFile;
using survey::ControlNetwork;
using survey::PointRole;

constexpr double kSamePlaceM = 0.05;

struct NetworkOptions {
  std::vector<std::filesystem::path> control;
  std::filesystem::path roles, grid_tie;
  std::vector<NamedFile> marks;
  formats::ControlSourceOptions source;
  std::string unknown_points = "error";
  std::string undetermined_points = "error";
  std::string coordinates = "grid", distances = "grid";
  int tie_parameters = 4;
  std::optional<double> combined_factor, ground_origin_easting, ground_origin_northing;
  double height_m = 0.0;

  const std::string& crs() const { return source.csv.crs; }
  bool tied() const { return !grid_tie.empty(); }
};

// Marks by block: the names of the points.
using MarkedBlocks = std::vector<std::pair<std::string, std::vector<std::string>>>;

double CombinedFactor(const NetworkOptions& options, const Eigen::Vector2d& place) {
  if (options.combined_factor) return *options.combined_factor;
  if (options.crs().empty()) {
    throw formats::UsageError("ground coordinates or distances need combined-factor, or a crs to compute it from");
  }
  return formats::GridScaleAt(options.crs(), place, options.height_m).Combined();
}

Eigen::Vector2d Centre(const std::vector<Eigen::Vector2d>& places) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& place : places) sum += place;
  return places.empty() ? sum : Eigen::Vector2d(sum / static_cast<double>(places.size()));
}

std::vector<std::string> AllMarked(const MarkedBlocks& blocks) {
  std::vector<std::string> names;
  for (const auto& [block, marked] : blocks) names.insert(names.end(), marked.begin(), marked.end());
  return names;
}

ControlNetwork Adjusted(formats::NetworkFile file, const NetworkOptions& options, const MarkedBlocks& blocks,
                        pipeline::StageRun& run) {
  std::string remark;
  if (options.distances == "ground") {
    std::vector<Eigen::Vector2d> known;
    for (const survey::NetworkPoint& point : file.network.points) {
      if (point.plane_known) known.push_back(point.position.head<2>());
    }
    const double factor = CombinedFactor(options, Centre(known));
    file.network.geometry.combined_factor = factor;
    char text[120];
    std::snprintf(text, sizeof text,
                  "distances were observed on the ground: grid is ground times the combined factor %.8f", factor);
    remark = text;
  }
  survey::AdjustedControl adjusted =
      survey::AdjustControl(std::move(file.network), options.undetermined_points == "leave-out",
                            {.fixed_sigma_m = options.source.csv.default_sigma_m,
                             .degrees = file.angle_unit == formats::AngleUnit::kDegrees,
                             .correlate_always = AllMarked(blocks)});
  for (const std::string& warning : adjusted.warnings) run.Warn(options.control.front().string() + ": " + warning);
  if (!adjusted.usable) throw DataError(options.control.front().string() + ": " + adjusted.message);
  if (!remark.empty()) adjusted.control.remarks.push_back(remark);
  return std::move(adjusted.control);
}

void ReportAdjustment(const survey::AdjustmentSummary& summary, pipeline::StageRun& run) {
  char text[300];
  std::snprintf(text, sizeof text,
                "%d observations, %d unknowns, sigma zero %.4g (a priori %.4g), chi-square %.2f (%.2f to %.2f)",
                summary.num_observations, summary.num_unknowns, summary.sigma_zero, summary.sigma_zero_a_priori,
                summary.chi_square, summary.chi_square_lower, summary.chi_square_upper);
  run.Message(text);
  if (summary.degrees_of_freedom > 0 && !summary.ChiSquareHolds()) {
    run.Warn("the chi-square test of the control network fails: see `plumbline show` of control.sqlite");
  }
  if (summary.num_suspected > 0) {
    run.Warn(std::to_string(summary.num_suspected) +
             " observations of the control network are suspected outliers; none is left out: see `plumbline show` of "
             "control.sqlite");
  }
}

void ApplyRoles(const std::filesystem::path& file, ControlNetwork* network) {
  for (const formats::PointRoleRow& row : formats::ReadRolesCsv(file)) {
    const auto point = std::find_if(network->points.begin(), network->points.end(),
                                    [&](const auto& p) { return p.name == row.point; });
    if (point == network->points.end()) throw DataError(row.where + ": point " + row.point + " is not in the control");
    point->role = row.role;
    point->reason = row.reason;
  }
}

// From the system of the file into that of the site.
void BringIntoSite(const NetworkOptions& options, ControlNetwork* network, pipeline::StageRun& run) {
  const std::size_t first = network->remarks.size();
  if (options.coordinates == "ground") {
    std::vector<Eigen::Vector2d> places;
    for (const survey::ControlPoint& point : network->points) {
      if (!point.covariance.isZero(0.0)) places.push_back(point.position_in_site);
    }
    const Eigen::Vector2d centre = Centre(places);
    const Eigen::Vector2d origin(options.ground_origin_easting.value_or(centre.x()),
                                 options.ground_origin_northing.value_or(centre.y()));
    survey::ReduceToGrid(CombinedFactor(options, centre), origin, network);
  }
  if (options.tied()) {
    const std::vector<survey::TiePoint> points = formats::ReadTieCsv(options.grid_tie);
    const survey::SiteTie tie = survey::FitSiteTie(points, options.tie_parameters == 4);
    if (!tie.usable) throw DataError(options.grid_tie.string() + ": " + tie.message);
    survey::ApplySiteTie(tie, points, network);
  }
  for (std::size_t i = first; i < network->remarks.size(); ++i) run.Message(network->remarks[i]);
}

ControlNetwork ReadNetwork(const NetworkOptions& options, const MarkedBlocks& blocks, pipeline::StageRun& run) {
  const survey::SiteFrame frame = {.crs = options.crs(), .wkt2 = formats::Wkt2OfCrs(options.crs())};
  if (options.control.empty()) return {.frame = frame};
  if (options.control.size() > 1) {
    throw DataError(options.control[1].string() + ": a site has one control file, and " + options.control[0].string() +
                    " is there already");
  }
  formats::ControlSourceOptions reading = options.source;
  if (options.tied() || options.coordinates == "ground") reading.csv.crs.clear();  // not yet in the site's system
  formats::ControlSource source = formats::ReadControlSource(options.control.front(), reading);
  for (const std::string& warning : source.warnings) run.Warn(warning);
  if (source.num_default_sigmas > 0) {
    char text[120];
    std::snprintf(text, sizeof text, "%d points without sigmas take default-sigma-m = %g", source.num_default_sigmas,
                  options.source.csv.default_sigma_m);
    run.Message(text);
  }
  ControlNetwork network =
      source.network ? Adjusted(std::move(*source.network), options, blocks, run) : std::move(source.control);
  network.frame = frame;
  if (network.adjustment) ReportAdjustment(*network.adjustment, run);
  if (!options.roles.empty()) ApplyRoles(options.roles, &network);
  BringIntoSite(options, &network, run);
  if (source.network || reading.csv.crs != options.crs()) {
    std::vector<std::string> warnings;
    formats::CheckControlArea(network.points, options.crs(),
                              std::vector<std::string>(network.points.size(), options.control.front().string() + ": "),
                              &warnings);
    for (const std::string& warning : warnings) run.Warn(warning);
  }
  for (const auto& [check, control] : survey::ChecksOnControl(network, kSamePlaceM)) {
    throw DataError(options.control.front().string() + ": check point " + check +
                    " is the same place as control point " + control +
                    " (nearer than 5 cm): a check must not be control");
  }
  return network;
}

void RefuseUnknownPoint(const ControlNetwork& network, const std::string& point, const std::string& where) {
  std::string hint;
  for (const std::string& name : survey::SimilarNames(network, point, 3)) {
    hint += (hint.empty() ? "; did you mean " : " or ") + name;
  }
  throw DataError(where + ": point " + point + " is not in the control list" + (hint.empty() ? "" : hint + "?") +
                  " (unknown-points = \"tie\" takes unknown points as places without coordinates)");
}

// Points of marks that no list knows become tie points, or are refused. Without a control list there is nothing to
// misspell, so all of them are ties.
void AddUnknownPoints(const NetworkOptions& options, const NamedFile& marks, ControlNetwork* network) {
  const ControlNetwork listed = *network;
  std::vector<int> rows;
  const std::vector<survey::Mark> file_marks = formats::ReadMarksCsv(marks.file, &rows);
  std::vector<survey::ControlPoint> unknown;
  for (std::size_t i = 0; i < file_marks.size(); ++i) {
    const std::string& point = file_marks[i].point;
    const bool known = survey::FindPoint(listed, point) != nullptr ||
                       std::any_of(unknown.begin(), unknown.end(), [&](const auto& p) { return p.name == point; });
    if (known) continue;
    if (!options.control.empty() && options.unknown_points == "error") {
      RefuseUnknownPoint(listed, point, marks.file.string() + ":" + std::to_string(rows[i]));
    }
    unknown.push_back({.name = point, .role = PointRole::kTie});
  }
  survey::AddPoints(unknown, network);
}

// All that an extract holds, as text, to be hashed: what it does not name cannot change the extract.
std::string CanonicalText(const ControlNetwork& network) {
  std::string text = network.frame.crs + "\n";
  char numbers[260];
  for (const survey::ControlPoint& point : network.points) {
    std::snprintf(numbers, sizeof numbers, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,", point.position_in_site.x(),
                  point.position_in_site.y(), point.covariance(0, 0), point.covariance(0, 1), point.covariance(1, 1),
                  point.elevation_m.value_or(-1e9), point.elevation_sigma_m.value_or(-1.0));
    text += point.name + "," + std::string(survey::Name(point.role)) + numbers + point.description + "\n";
  }
  for (const survey::PointCorrelation& pair : network.correlations) {
    std::snprintf(numbers, sizeof numbers, "%d,%d,%.17g,%.17g,%.17g,%.17g\n", pair.a, pair.b, pair.covariance(0, 0),
                  pair.covariance(0, 1), pair.covariance(1, 0), pair.covariance(1, 1));
    text += numbers;
  }
  return text;
}

void WriteExtract(const std::filesystem::path& file, const std::string& role, const ControlNetwork& extract,
                  pipeline::StageRun& run) {
  const formats::ProvenanceInput points = {.role = role, .sha256 = formats::Sha256(CanonicalText(extract))};
  formats::WriteControl(file, extract, run.ProvenanceOf({points}));
}

// Where the extracts go; empty: not wanted.
struct ExtractFiles {
  std::filesystem::path folder;  // <block>/control.sqlite
  std::filesystem::path joint;   // of all blocks together
};

void WriteExtracts(const ExtractFiles& files, const ControlNetwork& network, const MarkedBlocks& blocks,
                   pipeline::StageRun& run) {
  std::vector<std::string> all;
  for (const auto& [block, names] : blocks) {
    all.insert(all.end(), names.begin(), names.end());
    if (files.folder.empty()) continue;
    WriteExtract(files.folder / block / "control.sqlite", "points of block " + block,
                 survey::ExtractOfBlock(network, names), run);
  }
  if (!files.joint.empty())
    WriteExtract(files.joint, "points of all blocks", survey::ExtractOfBlock(network, all), run);
}

std::string Summary(const ControlNetwork& network) {
  int count[4] = {};
  for (const survey::ControlPoint& point : network.points) ++count[static_cast<int>(point.role)];
  return std::to_string(count[0]) + " control, " + std::to_string(count[1]) + " check, " + std::to_string(count[2]) +
         " tie, " + std::to_string(count[3]) + " excluded points";
}

MarkedBlocks ReadMarkedBlocks(const NetworkOptions& options) {
  MarkedBlocks blocks;
  for (const NamedFile& marks : options.marks) {
    if (std::any_of(blocks.begin(), blocks.end(), [&](const auto& block) { return block.first == marks.name; })) {
      throw formats::UsageError("--marks names block " + marks.name + " twice");
    }
    std::vector<std::string> names;
    for (const survey::Mark& mark : formats::ReadMarksCsv(marks.file)) names.push_back(mark.point);
    blocks.emplace_back(marks.name, std::move(names));
  }
  return blocks;
}

void Run(const NetworkOptions& options, const std::filesystem::path& output, const ExtractFiles& extracts,
         pipeline::StageRun& run) {
  const MarkedBlocks blocks = ReadMarkedBlocks(options);
  ControlNetwork network = ReadNetwork(options, blocks, run);
  for (const NamedFile& marks : options.marks) AddUnknownPoints(options, marks, &network);
  for (const auto& [block, names] : blocks) {
    std::string text;
    for (const std::string& name : std::set<std::string>(names.begin(), names.end())) text += name + "\n";
    run.AddInput({.role = "points marked in block " + block, .sha256 = formats::Sha256(text)});
  }
  formats::WriteControl(output, network, run.Provenance());
  WriteExtracts(extracts, network, blocks, run);
  run.Message(Summary(network));
}

void DeclareReading(NetworkOptions* options, pipeline::Stage* stage) {
  formats::ControlCsvOptions& csv = options->source.csv;
  formats::StarnetSigmas& starnet = options->source.starnet;
  stage->Option("control-order", &csv.order, "order of a control list without a header: pnezd, penzd or navvis",
                {"", "pnezd", "penzd", "navvis"});
  stage->Option("default-sigma-m", &csv.default_sigma_m, "1 sigma per axis of points without sigmas (m)",
                {.min = 1e-6, .max = 10.0});
  stage->Option("crs", &csv.crs, "projected system of the control, e.g. EPSG:25832; empty: its own plane");
  stage->Option("unknown-points", &options->unknown_points,
                "marks on points that the control list does not know: error or tie", {"error", "tie"});
  stage->Option("undetermined-points", &options->undetermined_points,
                "points that the observations do not determine: error or leave-out", {"error", "leave-out"});
  stage->Option("starnet-distance-sigma-m", &starnet.distance_m,
                "STAR*NET distances without one: 1 sigma (m; 0: refuse)", {.min = 0.0, .max = 1.0});
  stage->Option("starnet-distance-ppm", &starnet.distance_ppm, "and in addition, by distance (ppm)",
                {.min = 0.0, .max = 1000.0});
  stage->Option("starnet-angle-sigma-arcsec", &starnet.angle_arcsec, "STAR*NET angles and directions (0: refuse)",
                {.min = 0.0, .max = 3600.0});
  stage->Option("starnet-azimuth-sigma-arcsec", &starnet.azimuth_arcsec, "STAR*NET bearings (0: refuse)",
                {.min = 0.0, .max = 3600.0});
  stage->Option("starnet-zenith-sigma-arcsec", &starnet.zenith_arcsec, "STAR*NET zenith angles (0: refuse)",
                {.min = 0.0, .max = 3600.0});
  stage->Option("starnet-levelling-sigma-m-per-sqrt-km", &starnet.levelling_m_per_sqrt_km,
                "STAR*NET height differences (0: refuse)", {.min = 0.0, .max = 1.0});
}

void DeclareSystem(NetworkOptions* options, pipeline::Stage* stage) {
  stage->Option("coordinates", &options->coordinates, "the control's coordinates are grid or ground ones",
                {"grid", "ground"});
  stage->Option("distances", &options->distances, "observed distances are reduced to the grid, or lie on the ground",
                {"grid", "ground"});
  stage->Option("combined-factor", &options->combined_factor,
                "ground times factor is grid; not given: from the crs and ellipsoidal-height-m",
                {.min = 0.9, .max = 1.1});
  stage->Option("ellipsoidal-height-m", &options->height_m, "height of the site above the ellipsoid (m)",
                {.min = -1000.0, .max = 10000.0});
  stage->Option("ground-origin-easting", &options->ground_origin_easting,
                "where ground and grid coordinates agree (m); not given: the centre of the points");
  stage->Option("ground-origin-northing", &options->ground_origin_northing, "the same, northing (m)");
  stage->Option("tie-parameters", &options->tie_parameters,
                "of the tie of a site grid: 3 (shift, rotation) or 4 (and scale)", {.min = 3, .max = 4});
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("network", "Adjust and check the control; write the points each block may use.",
                        "plumbline network --control control/points.csv --marks B1=blocks/B1/marks.csv --output "
                        "work/control.sqlite --extracts work");
  NetworkOptions options;
  std::filesystem::path output;
  ExtractFiles extracts;
  stage.Inputs("control", &options.control, "control: .csv .txt .xml (points) or .gkf .dat .xml (observations)", false,
               Content::kTextWithoutComments);
  stage.OptionalInput("roles", &options.roles, "point,role,reason (CSV), for control that comes without roles",
                      Content::kTextWithoutComments);
  stage.OptionalInput("grid-tie", &options.grid_tie,
                      "points known in the site grid and in the crs (CSV): the control is in the site grid",
                      Content::kTextWithoutComments);
  stage.NamedInputs("marks", &options.marks, "marks.csv of each block that has one", false, Content::kParsed);
  stage.Output("output", &output, "control.sqlite to write");
  stage.OptionalOutput("extracts", &extracts.folder, "folder for <block>/control.sqlite");
  stage.OptionalOutput("joint-extract", &extracts.joint, "the same of all blocks together, for `plumbline join`");
  DeclareReading(&options, &stage);
  DeclareSystem(&options, &stage);
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) { Run(options, output, extracts, run); });
}
