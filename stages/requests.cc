// SPDX-License-Identifier: Apache-2.0
//
// plumbline-requests: what a person should look at. Gathers the doubts about all blocks, groups them on their paths and
// writes them as one ranked list, each with a picture.
#include <algorithm>
#include <cstdio>
#include <set>

#include "formats/answers_file.h"
#include "formats/artefacts.h"
#include "formats/digest.h"
#include "formats/raster_file.h"
#include "formats/request_picture.h"
#include "formats/requests_file.h"
#include "pipeline/site_edits.h"
#include "pipeline/stage.h"
#include "survey/accuracy/contradiction.h"
#include "survey/sensors/scan_points.h"
#include "survey/submaps/rendering.h"

namespace {

namespace fs = std::filesystem;
using pipeline::NamedFile;

constexpr const char* kPictures = "requests";
constexpr double kMaxRange_m = 30.0;
constexpr std::size_t kMostPoints = 400;

struct RequestFiles {
  std::vector<NamedFile> sessions, tracks, loops, solutions, grids, answers, edits;
  fs::path output;
};

// Everything of one block; read when its turn comes.
struct Block {
  std::string name;
  survey::Session session;
  survey::Track track;
  survey::Loops loops;
  survey::Solution solution;
  survey::RasterStrips grid;
  std::vector<survey::StampNs> stamps;
  std::vector<fs::path> answer_files;
  survey::Answers answers;
};

fs::path FileOf(const std::string& block, const std::vector<NamedFile>& files, const char* option) {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const NamedFile& file) { return file.name == block; });
  if (found == files.end())
    throw formats::UsageError(std::string("--") + option + " of block " + block + " is missing");
  return found->file;
}

Block ReadBlock(const std::string& name, const RequestFiles& files) {
  Block block{.name = name};
  const fs::path solution = FileOf(name, files.solutions, "solution");
  block.session = formats::ReadSession(FileOf(name, files.sessions, "session"));
  block.track = formats::ReadTrack(FileOf(name, files.tracks, "track"));
  block.loops = formats::ReadLoops(FileOf(name, files.loops, "loops"));
  block.solution = formats::ReadSolution(solution);
  const std::size_t scans = block.session.scans.size();
  if (block.track.scans.size() != scans || block.solution.scans.size() != scans) {
    throw formats::DataError(solution.string() + ": session, track and solution of block " + name +
                             " do not have the same scans: they do not belong together");
  }
  formats::RasterLabel label;
  block.grid = formats::OpenRaster(FileOf(name, files.grids, "grid"), &label);
  block.stamps = survey::ClockStamps(survey::StampsOfScans(block.session));
  for (const NamedFile& answer : files.answers) {
    if (answer.name == name) block.answer_files.push_back(answer.file);
  }
  block.answers = formats::ReadAnswers(block.answer_files, block.stamps);
  return block;
}

std::vector<survey::Pose2> PosesOf(const survey::Solution& solution) {
  std::vector<survey::Pose2> poses;
  for (const survey::SolvedScan& scan : solution.scans) poses.push_back(scan.site_from_scan);
  return poses;
}

std::size_t Index(survey::ScanId scan) { return static_cast<std::size_t>(scan.value); }

std::vector<Eigen::Vector2f> PointsOf(const Block& block, survey::ScanId scan) {
  const survey::ScanProjector projector(block.session.geometries, kMaxRange_m, 0.0);
  const auto pose_of = [&](std::size_t i) { return block.solution.scans[i].site_from_scan; };
  survey::ScanPoints points;
  projector.Project(block.session, Index(scan), survey::TwistOfScan(block.session.scans, pose_of, Index(scan)),
                    &points);
  std::vector<Eigen::Vector2f> thinned;
  survey::ThinAlongScan(points.hits, 0.02, kMostPoints, &thinned);
  return thinned;
}

formats::ListedPose PoseOf(const Block& block, const survey::Request& request) {
  const auto stamp = [&](survey::ScanId scan) { return block.stamps[Index(scan)]; };
  const auto pose = [&](survey::ScanId scan) { return block.solution.scans[Index(scan)].site_from_scan; };
  formats::ListedPose listed{.stamp_ns = stamp(request.scan),
                             .from_ns = stamp(request.stretch.first),
                             .until_ns = stamp(request.stretch.last),
                             .estimate = pose(request.scan),
                             .spread = request.spread,
                             .modes = request.modes,
                             .points = PointsOf(block, request.scan)};
  if (request.reference) {
    const survey::ScanId scan = request.reference->scan;
    listed.reference = {stamp(scan), pose(scan), request.reference->earlier_pass};
    listed.reference_points = PointsOf(block, scan);
  }
  if (request.answer) {
    const survey::Answer& answer = block.answers[*request.answer];
    listed.answer = {block.name + "/answers/" + answer.name, answer.decision, stamp(answer.scan)};
  }
  return listed;
}

// `what`: stamp of the scan or uid of the edit.
formats::ListedRequest Listed(const std::string& block, const std::string& what,
                              const std::vector<survey::RequestCause>& causes, double score_m) {
  formats::ListedRequest listed{.id = formats::IdOfRequest(block, what, causes.front().cause),
                                .block = block,
                                .causes = causes,
                                .score_m = score_m};
  listed.picture = std::string(kPictures) + "/" + listed.id + ".png";
  return listed;
}

void Draw(const Block& block, const survey::Request& request, const formats::ListedPose& listed,
          const fs::path& picture_file) {
  formats::RequestPicture picture{.estimate = listed.estimate, .points = listed.points};
  for (const survey::PoseMode& mode : listed.modes) picture.modes.push_back(mode.site_from_scan);
  for (survey::ScanId scan = request.stretch.first; !(request.stretch.last < scan); ++scan.value)
    picture.way.push_back(block.solution.scans[Index(scan)].site_from_scan.Translation());
  if (listed.reference) picture.reference = listed.reference->site_from_scan;
  formats::WriteRequestPicture(picture_file, block.grid, picture);
}

survey::BlockReview ReviewOf(const Block& block, const std::vector<survey::Request>& requests,
                             const survey::Contradiction& passes) {
  survey::BlockReview review{.num_requests = static_cast<int>(requests.size()),
                             .num_answers = static_cast<int>(block.answers.size()),
                             .cells_compared = passes.compared,
                             .cells_contradicted = passes.contradicted};
  for (const survey::Request& request : requests) {
    const bool skipped = request.answer && block.answers[*request.answer].decision == survey::Decision::kSkip;
    int& count = !request.answer ? review.num_open : skipped ? review.num_skipped : review.num_answered;
    ++count;
  }
  return review;
}

// Returns how many edits of the block are asked about.
int AddEdits(const Block& block, const std::vector<survey::EditRequest>& requests, const fs::path& folder,
             formats::RequestList* list) {
  int count = 0;
  for (const survey::EditRequest& request : requests) {
    if (request.block != block.name) continue;
    formats::ListedRequest listed = Listed(block.name, request.applied.edit.uid, request.causes, request.score_m);
    listed.subject = request.applied;
    formats::WriteEditPicture(folder / listed.picture, block.grid, request.applied);
    list->requests.push_back(std::move(listed));
    ++count;
  }
  return count;
}

void AddBlock(const Block& block, const survey::RequestOptions& options, const RequestFiles& files,
              const std::vector<survey::EditRequest>& edit_requests, formats::RequestList* list) {
  const survey::PassComparison passes = survey::ComparePasses(block.session, PosesOf(block.solution), {});
  const std::vector<survey::Doubt> doubts =
      survey::FindDoubts({block.track, block.loops, block.solution, block.stamps, passes.conflicts});
  const std::vector<survey::Request> requests = survey::MakeRequests(doubts, block.solution, block.answers, options);
  const fs::path folder = files.output.parent_path();
  for (const survey::Request& request : requests) {
    const formats::ListedPose pose = PoseOf(block, request);
    formats::ListedRequest listed = Listed(block.name, std::to_string(pose.stamp_ns), request.causes, request.score_m);
    listed.subject = pose;
    Draw(block, request, pose, folder / listed.picture);
    list->requests.push_back(std::move(listed));
  }
  survey::BlockReview review = ReviewOf(block, requests, passes.total);
  const int of_edits = AddEdits(block, edit_requests, folder, list);
  review.num_requests += of_edits;
  review.num_open += of_edits;  // one that was settled is in doubt no more
  const fs::path grid = FileOf(block.name, files.grids, "grid");
  list->blocks.push_back({.name = block.name,
                          .tied = block.solution.tied,
                          .crs = block.solution.frame.crs,
                          .map = grid.lexically_proximate(folder).generic_string(),
                          .review = review});
}

void RemoveOldPictures(const formats::RequestList& list, const fs::path& folder) {
  std::set<fs::path> wanted;
  for (const formats::ListedRequest& request : list.requests) wanted.insert(folder / request.picture);
  if (!fs::is_directory(folder / kPictures)) return;
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / kPictures)) {
    if (entry.path().extension() == ".png" && !wanted.contains(entry.path())) old.push_back(entry.path());
  }
  for (const fs::path& picture : old) fs::remove(picture);
}

void Summarize(const formats::RequestList& list, pipeline::StageRun& run) {
  for (const formats::ListedBlock& block : list.blocks) {
    const survey::BlockReview& review = block.review;
    char text[200];
    std::snprintf(text, sizeof text, ": %d requests, %d answered, %d skipped, %d open", review.num_requests,
                  review.num_answered, review.num_skipped, review.num_open);
    std::string line = block.name + text;
    if (review.cells_compared > 0) {
      std::snprintf(text, sizeof text, "; of %d wall cells another pass contradicts %.2f %%", review.cells_compared,
                    100.0 * review.ContradictedShare());
      line += text;
    }
    run.Message(line);
  }
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage(
      "requests",
      "List what a person should look at: places where the poses are in doubt, edits that could not follow.",
      "plumbline requests --session B1=work/B1/session.sqlite --track B1=work/B1/track.sqlite "
      "--loops B1=work/B1/loops.sqlite --solution B1=work/B1/solution.sqlite "
      "--grid B1=work/B1/grid.tif --output work/requests.jsonl");
  RequestFiles files;
  survey::RequestOptions options;
  stage.NamedInputs("session", &files.sessions, "session of each block", true);
  stage.NamedInputs("track", &files.tracks, "track of each block", true);
  stage.NamedInputs("loops", &files.loops, "loops of each block", true);
  stage.NamedInputs("solution", &files.solutions, "solution of each block", true);
  stage.NamedInputs("grid", &files.grids, "map of each block, for the pictures", true);
  stage.NamedInputs("answers", &files.answers, "a person's answers, JSON, each with the name of its block", false,
                    pipeline::Content::kParsed);
  stage.NamedInputs("edits", &files.edits, "doubtful_edits.json of each block", false);
  stage.Output("output", &files.output, "requests.jsonl to write; pictures go into the folder requests beside it");
  stage.Option("least-doubt-m", &options.least_doubt_m, "smaller doubts about a pose are not asked (m)",
               {.min = 0.0, .max = 10.0});
  stage.Option("earlier-pass-m", &options.earlier_pass_m, "path back to an earlier pass, at least (m)", {.min = 1.0});
  stage.Option("in-view-m", &options.in_view_m, "distance from a scan to that of an earlier pass, at most (m)",
               {.min = 0.5, .max = 100.0});
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    formats::RequestList list;
    const std::vector<survey::EditRequest> of_edits = survey::MakeEditRequests(pipeline::ReadBlockEdits(files.edits));
    for (const NamedFile& session : files.sessions) {
      const Block block = ReadBlock(session.name, files);
      if (!block.answers.empty())
        run.AddInput({"answers " + block.name, formats::Sha256(formats::CanonicalText(block.answers))});
      AddBlock(block, options, files, of_edits, &list);
    }
    formats::Rank(&list.requests);
    formats::WriteRequests(files.output, list, run.Provenance());
    RemoveOldPictures(list, files.output.parent_path());
    Summarize(list, run);
  });
}
