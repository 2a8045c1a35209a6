// SPDX-License-Identifier: Apache-2.0
//
// Reads the control list, checks the blocks' marks against it and writes control.sqlite with all points, and for each
// block the extract that its adjustment may see. An extract's provenance depends on its own points alone, so that a
// change of another point leaves it as it is.
#include <algorithm>
#include <cstdio>
#include <set>

#include "formats/artefacts.h"
#include "formats/control_csv.h"
#include "formats/digest.h"
#include "formats/field_csv.h"
#include "formats/raster_file.h"
#include "pipeline/stage.h"
#include "survey/control/block_extract.h"

namespace {

using pipeline::Content;
using pipeline::NamedFile;
using survey::ControlNetwork;
using survey::PointRole;

constexpr double kSamePlaceM = 0.05;

struct NetworkOptions {
  std::filesystem::path control;
  std::vector<NamedFile> marks;
  formats::ControlCsvOptions csv;
  std::string unknown_points = "error";
};

ControlNetwork ReadNetwork(const NetworkOptions& options, pipeline::StageRun& run) {
  ControlNetwork network{.frame = {.crs = options.csv.crs, .wkt2 = formats::Wkt2OfCrs(options.csv.crs)}};
  if (options.control.empty()) return network;
  formats::ControlCsv csv = formats::ReadControlCsv(options.control, options.csv);
  for (const std::string& warning : csv.warnings) run.Warn(warning);
  if (csv.num_default_sigmas > 0) {
    char text[120];
    std::snprintf(text, sizeof text, "%d points without sigmas take default-sigma-m = %g", csv.num_default_sigmas,
                  options.csv.default_sigma_m);
    run.Message(text);
  }
  network.points = std::move(csv.points);
  for (const auto& [check, control] : survey::ChecksOnControl(network, kSamePlaceM)) {
    throw formats::DataError(options.control.string() + ": check point " + check +
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
  throw formats::DataError(where + ": point " + point + " is not in the control list" +
                           (hint.empty() ? "" : hint + "?") +
                           " (unknown-points = \"tie\" takes unknown points as places without coordinates)");
}

// The names marked in a block. Points that no list knows become tie points, or are refused. Without a control list
// there is nothing to misspell, so all of them are ties.
std::vector<std::string> MarkedNames(const NetworkOptions& options, const NamedFile& marks, ControlNetwork* network) {
  std::vector<std::string> names;
  const ControlNetwork listed = *network;
  std::vector<int> rows;
  const std::vector<survey::Mark> file_marks = formats::ReadMarksCsv(marks.file, &rows);
  for (std::size_t i = 0; i < file_marks.size(); ++i) {
    const std::string& point = file_marks[i].point;
    names.push_back(point);
    if (survey::FindPoint(*network, point) != nullptr) continue;
    if (!options.control.empty() && options.unknown_points == "error") {
      RefuseUnknownPoint(listed, point, marks.file.string() + ":" + std::to_string(rows[i]));
    }
    network->points.push_back({.name = point, .role = PointRole::kTie});
  }
  std::sort(network->points.begin(), network->points.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return names;
}

// All that an extract holds, as text, to be hashed: what it does not name cannot change the extract.
std::string CanonicalText(const ControlNetwork& network) {
  std::string text = network.frame.crs + "\n";
  for (const survey::ControlPoint& point : network.points) {
    char numbers[200];
    std::snprintf(numbers, sizeof numbers, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,", point.position_in_site.x(),
                  point.position_in_site.y(), point.covariance(0, 0), point.covariance(0, 1), point.covariance(1, 1),
                  point.elevation_m.value_or(-1e9));
    text += point.name + "," + std::string(survey::Name(point.role)) + numbers + point.description + "\n";
  }
  return text;
}

void WriteExtract(const std::filesystem::path& folder, const std::string& block, const ControlNetwork& extract,
                  pipeline::StageRun& run) {
  const formats::ProvenanceInput points = {.role = "points of block " + block,
                                           .sha256 = formats::Sha256(CanonicalText(extract))};
  formats::WriteControl(folder / block / "control.sqlite", extract, run.ProvenanceOf({points}));
}

std::string Summary(const ControlNetwork& network) {
  int count[4] = {};
  for (const survey::ControlPoint& point : network.points) ++count[static_cast<int>(point.role)];
  return std::to_string(count[0]) + " control, " + std::to_string(count[1]) + " check, " + std::to_string(count[2]) +
         " tie, " + std::to_string(count[3]) + " excluded points";
}

void Run(const NetworkOptions& options, const std::filesystem::path& output, const std::filesystem::path& extracts,
         pipeline::StageRun& run) {
  ControlNetwork network = ReadNetwork(options, run);
  std::vector<std::pair<std::string, std::vector<std::string>>> blocks;
  for (const NamedFile& marks : options.marks) {
    if (std::any_of(blocks.begin(), blocks.end(), [&](const auto& block) { return block.first == marks.name; })) {
      throw formats::UsageError("--marks names block " + marks.name + " twice");
    }
    blocks.emplace_back(marks.name, MarkedNames(options, marks, &network));
  }
  for (const auto& [block, names] : blocks) {
    std::string text;
    for (const std::string& name : std::set<std::string>(names.begin(), names.end())) text += name + "\n";
    run.AddInput({.role = "points marked in block " + block, .sha256 = formats::Sha256(text)});
  }
  formats::WriteControl(output, network, run.Provenance());
  for (const auto& [block, names] : blocks) {
    if (!extracts.empty()) WriteExtract(extracts, block, survey::ExtractOfBlock(network, names), run);
  }
  run.Message(Summary(network));
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("network", "Check the control list and the blocks' marks; write the points each block may use.",
                        "plumbline network --control control/points.csv --marks B1=blocks/B1/marks.csv --output "
                        "work/control.sqlite --extracts work");
  NetworkOptions options;
  std::filesystem::path output, extracts;
  stage.OptionalInput("control", &options.control, "control list (CSV)", Content::kTextWithoutComments);
  stage.NamedInputs("marks", &options.marks, "marks.csv of each block that has one", false, Content::kParsed);
  stage.Output("output", &output, "control.sqlite to write");
  stage.OptionalOutput("extracts", &extracts, "folder for <block>/control.sqlite");
  stage.Option("control-order", &options.csv.order, "order of a control list without a header: pnezd or penzd",
               {"", "pnezd", "penzd"});
  stage.Option("default-sigma-m", &options.csv.default_sigma_m, "1 sigma per axis of points without sigmas (m)",
               {.min = 1e-6, .max = 10.0});
  stage.Option("crs", &options.csv.crs, "projected system of the control, e.g. EPSG:25832; empty: its own plane");
  stage.Option("unknown-points", &options.unknown_points,
               "marks on points that the control list does not know: error or tie", {"error", "tie"});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) { Run(options, output, extracts, run); });
}
