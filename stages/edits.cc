// SPDX-License-Identifier: Apache-2.0
//
// plumbline-edits: what people want changed in the maps of a site, into its ledger and out of it.
#include <algorithm>
#include <array>
#include <ctime>
#include <iostream>

#include "formats/edit_package.h"
#include "formats/edits_file.h"
#include "formats/text_table.h"
#include "pipeline/ros_replies.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"

namespace {

namespace fs = std::filesystem;
using formats::LedgerLine;
using formats::LedgerOperation;
using formats::UsageError;
using survey::MapEdit;

struct Request {
  fs::path action;
  fs::path site;
  fs::path from;
  fs::path geopackage;
  std::string uid;
  std::string who;
  std::string why;
};

std::string Now() {
  const std::time_t now = std::time(nullptr);
  std::array<char, 32> text{};
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

// What a drawn edit does not say itself.
void FillIn(const Request& request, MapEdit* edit) {
  if (edit->who.empty()) edit->who = request.who;
  if (edit->why.empty()) edit->why = request.why;
  if (edit->when.empty()) edit->when = Now();
  if (edit->tool.empty()) edit->tool = "plumbline edits";
}

void Record(const Request& request, std::vector<LedgerLine> lines, pipeline::StageRun& run) {
  const std::size_t count = lines.size();
  pipeline::RecordEdits(request.site, std::move(lines));
  run.Message(std::to_string(count) + (count == 1 ? " line" : " lines") + " appended to " +
              pipeline::LedgerFile(request.site).string());
}

// The edits of a file; poses of the robot that are in it become answers.
std::vector<MapEdit> TakeDrawn(const Request& request, pipeline::StageRun& run) {
  if (request.from.extension() != ".jsonl")
    return formats::ReadEdits(request.from, pipeline::LabelOfSite(request.site).frame.crs);
  const std::string where = request.from.string();
  const formats::RosbridgeReply reply = formats::ReadRosbridge(request.from);
  std::vector<MapEdit> edits;
  if (reply.map) edits = pipeline::EditsOfRosGrid(request.site, *reply.map, where);
  pipeline::RecordPoses(request.site, reply.poses, request.who, where);
  if (!reply.poses.empty()) run.Message(std::to_string(reply.poses.size()) + " poses written as answers");
  for (MapEdit& edit : edits) edit.tool = "rosbridge";
  return edits;
}

void Add(const Request& request, pipeline::StageRun& run) {
  if (request.from.empty()) throw UsageError("--from is required: the file with the drawn edits");
  std::vector<LedgerLine> lines;
  for (MapEdit& edit : TakeDrawn(request, run)) {
    FillIn(request, &edit);
    const std::string which = request.from.extension() == ".jsonl" ? ": edit " : ": feature ";
    const std::string where = request.from.string() + which + std::to_string(lines.size() + 1);
    lines.push_back({LedgerOperation::kAdd, std::move(edit), where});
  }
  if (!lines.empty()) Record(request, std::move(lines), run);
}

void Retire(const Request& request, pipeline::StageRun& run) {
  if (request.uid.empty()) throw UsageError("--uid is required: the edit to retire");
  LedgerLine line{.operation = LedgerOperation::kRetire};
  line.edit.uid = request.uid;
  FillIn(request, &line.edit);
  Record(request, {line}, run);
}

// As it lies now, tied to the maps as they are now: settles what `requests` asks about it.
void Keep(const Request& request, pipeline::StageRun& run) {
  if (request.uid.empty()) throw UsageError("--uid is required: the edit to keep where it lies");
  const std::vector<MapEdit> placed = pipeline::PlacedEdits(request.site);
  const auto found =
      std::find_if(placed.begin(), placed.end(), [&](const auto& edit) { return edit.uid == request.uid; });
  if (found == placed.end()) throw UsageError("--uid " + request.uid + ": there is no such edit, or it was retired");
  LedgerLine line{.operation = LedgerOperation::kModify, .edit = *found};
  ++line.edit.revision;
  for (std::string* member : {&line.edit.when, &line.edit.tool}) member->clear();
  line.edit.basis.clear();
  if (!request.who.empty()) line.edit.who = request.who;
  if (!request.why.empty()) line.edit.why = request.why;
  FillIn(request, &line.edit);
  Record(request, {line}, run);
}

void Checkout(const Request& request, pipeline::StageRun& run) {
  if (request.geopackage.empty()) throw UsageError("--geopackage is required: the file for QGIS to write");
  formats::WriteEditPackage(request.geopackage, pipeline::PlacedEdits(request.site), pipeline::BasisOf(request.site),
                            pipeline::LabelOfSite(request.site));
  run.Message("draw in " + request.geopackage.string() + ", then: plumbline edits accept " + request.site.string() +
              " --from " + request.geopackage.string());
}

void Accept(const Request& request, pipeline::StageRun& run) {
  if (request.from.empty()) throw UsageError("--from is required: the GeoPackage that was checked out");
  std::vector<LedgerLine> lines = formats::ReadEditPackage(request.from);
  for (LedgerLine& line : lines) {
    if (line.operation != LedgerOperation::kAdd && !request.who.empty()) line.edit.who = request.who;
    line.edit.tool = "QGIS";
    FillIn(request, &line.edit);
  }
  if (lines.empty()) {
    run.Message("nothing was changed in " + request.from.string());
  } else {
    Record(request, std::move(lines), run);
  }
}

void List(const Request& request) {
  const std::vector<MapEdit> active = formats::ReadLedger(pipeline::LedgerFile(request.site)).Active();
  const formats::TextTable table({"uid", "rev", "kind", "class", "frame", "who", "when", "why"});
  table.Print(std::cout, [&](const auto& row) {
    for (const MapEdit& edit : active)
      row({edit.uid, std::to_string(edit.revision), std::string(Name(edit.kind)), std::string(Name(edit.obstacle)),
           std::string(Name(edit.frame)), edit.who, edit.when, formats::OneLine(edit.why)});
  });
}

void Do(const Request& request, pipeline::StageRun& run) {
  if (!fs::exists(request.site / "site.toml"))
    throw UsageError(request.site.string() + ": no site.toml in it, so it is not a site (plumbline new makes one)");
  if (request.action == "add") return Add(request, run);
  if (request.action == "retire") return Retire(request, run);
  if (request.action == "keep") return Keep(request, run);
  if (request.action == "list") return List(request);
  if (request.action == "checkout") return Checkout(request, run);
  if (request.action == "accept") return Accept(request, run);
  throw UsageError(request.action.string() + ": must be add, retire, keep, list, checkout or accept");
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "edits",
      "Map edits of a site: add drawn ones to its ledger, retire one (that undoes it), keep one where it lies although "
      "it could not follow the map well, list those that hold. `plumbline run` applies them.",
      "plumbline edits add office --from drawn.geojson --who \"M. Huber\"\n"
      "  plumbline edits retire office --uid 3f1c9a6e02b7 --who \"M. Huber\" --why \"wall is gone\"\n"
      "  plumbline edits list office");
  Request request;
  stage.Positional("ACTION", &request.action, "add, retire, keep, list, checkout or accept");
  stage.Positional("SITE", &request.site, "the site's folder");
  stage.OptionalInput(
      "from", &request.from,
      "drawn edits: GeoJSON or an edited map of rosbridge, .jsonl (add), the GeoPackage that was checked out (accept)",
      pipeline::Content::kParsed);
  stage.OptionalOutput("geopackage", &request.geopackage, "GeoPackage to write (checkout)");
  stage.Text("uid", &request.uid, "the edit to retire or to keep");
  stage.Text("who", &request.who, "who decided it, where the drawn edits do not say");
  stage.Text("why", &request.why, "why, likewise");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) { Do(request, run); });
}
