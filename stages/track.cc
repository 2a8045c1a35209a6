// SPDX-License-Identifier: Apache-2.0
//
// plumbline-track: the front end. Reads the session of a block, writes the pose of every scan in the block's local
// frame.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "formats/answers_file.h"
#include "formats/artefacts.h"
#include "formats/digest.h"
#include "formats/filter_checkpoint.h"
#include "pipeline/stage.h"
#include "survey/particles/filter_requests.h"
#include "survey/particles/filtered_track.h"
#include "survey/particles/particle_filter.h"
#include "survey/submaps/tracker.h"

namespace {

void DeclareOptions(pipeline::Stage* stage, survey::TrackOptions* options) {
  stage->Option("surface-cell-size-m", &options->map.surface_cell_size_m, "cell of the surfaces (m), surface matcher",
                {.min = 0.02, .max = 1.0});
  stage->Option("submap-cell-size-m", &options->map.grid.cell_size_m, "cell of the submaps (m), occupancy matcher",
                {.min = 0.005, .max = 1.0});
  stage->Option("max-range-m", &options->max_range_m, "ranges beyond are not used (m)", {.min = 1.0});
  stage->Option("max-points", &options->map.max_points, "end points used to match a scan", {.min = 20, .max = 100000});
  stage->Option("point-spacing-m", &options->map.point_spacing_m, "end points closer along the scan are thinned (m)",
                {.min = 0.0});
  stage->Option("insert-distance-m", &options->insert_distance_m, "a scan is drawn after this motion (m) ...",
                {.min = 0.0});
  stage->Option("insert-angle-rad", &options->insert_angle_rad, "... or this turn (rad)", {.min = 0.0});
  stage->Option("submap-nodes", &options->submap_nodes, "scans drawn into one submap", {.min = 2});
  stage->Option("search-half-width-m", &options->search_half_width_m, "farthest search when a match is poor (m)",
                {.min = 0.0});
  stage->Option("search-half-angle-rad", &options->search_half_angle_rad,
                "search when a match is poor (rad); twice that where nothing is found", {.min = 0.0});
}

// The IMU in the units of its data sheet.
struct ImuSheet {
  bool use = true;
  double latitude_deg = 50.0;
  double gyro_bias_deg_h = 200.0;
  double accelerometer_bias_mgal = 2000.0;
};

void DeclareImu(pipeline::Stage* stage, ImuSheet* sheet, survey::InertialNoise* noise) {
  stage->Option("use-imu", &sheet->use, "false: as if there were no IMU");
  stage->Option("latitude-deg", &sheet->latitude_deg, "of the site, for gravity and the Earth's rotation (deg)",
                {.min = -90, .max = 90});
  stage->Option("gyro-bias-deg-h", &sheet->gyro_bias_deg_h, "bias of the gyros, 1 sigma, where never at rest (deg/h)",
                {.min = 0.01, .max = 1e5});
  stage->Option("accelerometer-bias-mgal", &sheet->accelerometer_bias_mgal,
                "bias of the accelerometers, 1 sigma (mGal)", {.min = 1, .max = 1e5});
  stage->Option("gyro-noise-rad-s-rthz", &noise->gyro_noise_rad_s_rthz, "white noise of the gyros (rad/s/sqrt(Hz))",
                {.min = 1e-7, .max = 1.0});
  stage->Option("accelerometer-noise-m-s2-rthz", &noise->accelerometer_noise_m_s2_rthz,
                "white noise of the accelerometers, with the shaking of the platform (m/s2/sqrt(Hz))",
                {.min = 1e-6, .max = 10.0});
}

survey::InertialOptions Inertial(const ImuSheet& sheet, survey::InertialNoise noise) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  noise.gyro_bias_sigma_rad_s = sheet.gyro_bias_deg_h * kRadians / 3600.0;
  noise.accelerometer_bias_sigma_m_s2 = sheet.accelerometer_bias_mgal * 1e-5;
  survey::InertialOptions options;
  options.use = sheet.use;
  options.latitude_rad = sheet.latitude_deg * kRadians;
  options.noise = noise;
  return options;
}

void DeclareFilter(pipeline::Stage* stage, survey::ParticleFilterOptions* options) {
  stage->Option("particles", &options->particles, "of the particle filter", {.min = 1, .max = 10000});
  stage->Option("seed", &options->seed, "of the particle filter's random numbers", {.min = 0, .max = 9e15});
  stage->Option("update-distance-m", &options->update_distance_m,
                "the particle filter is updated after this motion (m) ...", {.min = 0.01});
  stage->Option("update-angle-rad", &options->update_angle_rad, "... or this turn (rad)", {.min = 0.01});
  stage->Option("motion-sigma-m", &options->matched_sigma_m_per_rtm,
                "what matched motion gets wrong: m per square root of m", {.min = 1e-5, .max = 1.0});
  stage->Option("motion-sigma-rad", &options->matched_sigma_rad_per_rtm, "... and rad per square root of m",
                {.min = 1e-6, .max = 1.0});
  stage->Option("weight-tempering", &options->proposal.tempering, "exponent of the particles' weights",
                {.min = 1e-3, .max = 1.0});
  stage->Option("resampling-share", &options->resampling_share,
                "particles are resampled when their effective number is below this share", {.min = 0.0, .max = 1.0});
  stage->Option("drops-together", &options->drops_together,
                "such drops so few updates apart make one request; 0: each is asked", {.min = 0, .max = 1000});
}

// What the updates depend on besides the answers: this program, the session, the options.
std::string KeyOfCheckpoint(pipeline::StageRun& run) {
  std::vector<formats::ProvenanceInput> inputs = run.Provenance().Own().inputs;
  std::erase_if(inputs, [](const formats::ProvenanceInput& input) { return input.role == "answers"; });
  return formats::Sha256OfFile("/proc/self/exe") + run.ProvenanceOf(inputs).Own().Id();
}

// [AS]: the filter's poses along its best trajectory. With a cache it goes on where the answers begin to differ from
// those of the last run.
survey::Track Filter(const survey::Session& session, const survey::Track& local, const survey::Answers& answers,
                     const survey::TrackOptions& tracking, const survey::ParticleFilterOptions& options,
                     const std::filesystem::path& cache, pipeline::StageRun& run) {
  const auto updates = static_cast<std::int64_t>(survey::ScansForUpdates(local, answers, options).size());
  pipeline::Progress progress = run.Track("updates", updates);
  formats::FilterCheckpoint now{.key = KeyOfCheckpoint(run), .answers = formats::AnswersInFilter(answers)};
  survey::TrajectoryTree known;
  if (const auto before = formats::ReadCheckpoint(cache); before && before->key == now.key)
    known = formats::UpdatesThatHold(*before, now.answers);
  now.tree = survey::RunParticleFilter(
      session, local, answers, tracking, options,
      [&](std::size_t done) { progress.Advance(static_cast<std::int64_t>(done)); }, known);
  if (!known.empty())
    run.Message(std::to_string(known.size()) + " of " + std::to_string(now.tree.size()) +
                " updates as in the last run");
  if (!cache.empty()) formats::WriteCheckpoint(cache, now);
  const survey::TrajectoryTree& tree = now.tree;
  survey::Track track = survey::FollowBestTrajectory(session, local, tree, answers, options);
  survey::AddFilterRequests(local, tree, options.drops_together, &track);
  return track;
}

std::string Summary(const survey::Track& track) {
  const survey::NavigationSummary& by = track.navigation;
  char navigated[160];
  std::snprintf(navigated, sizeof navigated,
                "; navigated by IMU %.1f s, odometry %.1f s, constant velocity %.1f s, without a match %.1f s",
                by.inertial_s, by.odometry_s, by.constant_velocity_s, by.unmatched_s);
  return std::to_string(track.scans.size()) + " scans, " + std::to_string(track.submaps.size()) + " submaps, " +
         std::to_string(track.constraints.size()) + " constraints, " + std::to_string(track.requests.size()) +
         " review requests" + navigated;
}

std::string ToldLead(double lead_s) {
  char text[80];
  std::snprintf(text, sizeof text, "the odometry %s the laser by %.2f s", lead_s > 0.0 ? "leads" : "lags",
                std::abs(lead_s));
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("track",
                        "Estimate the pose of every scan of a block in its local frame (LiDAR SLAM, without control).",
                        "plumbline track --session work/B1/session.sqlite --output work/B1/track.sqlite");
  std::filesystem::path session_file;
  std::filesystem::path output;
  survey::TrackOptions options;
  std::string engine = "scan-matching";
  std::string matcher = "surfaces";
  stage.Input("session", &session_file, "session of the block");
  std::vector<std::filesystem::path> answer_files;
  stage.Inputs("answers", &answer_files, "a person's answers about the block's scans, JSON; for the particle filter",
               false, pipeline::Content::kParsed);
  stage.Output("output", &output, "track.sqlite to write");
  std::filesystem::path cache;
  stage.OptionalOutput("cache", &cache,
                       "what the particle filter keeps for its next run, so that a changed answer runs it again from "
                       "its scan on; may be deleted");
  stage.Option("engine", &engine, "scan-matching [CN], or particle-filter [AS] on top of it",
               {"scan-matching", "particle-filter"});
  stage.Option("matcher", &matcher, "surfaces, or occupancy: [CN] eq. (6)-(7) as written", {"surfaces", "occupancy"});
  bool use_odometry = true;
  stage.Option("use-odometry", &use_odometry, "false: as if the wheels had not been recorded");
  DeclareOptions(&stage, &options);
  ImuSheet imu;
  DeclareImu(&stage, &imu, &options.inertial.noise);
  survey::ParticleFilterOptions filter;
  DeclareFilter(&stage, &filter);
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    if (matcher == "occupancy") options.map.matcher = survey::Matcher::kOccupancy;
    survey::Session session = formats::ReadSession(session_file);
    options.inertial = Inertial(imu, options.inertial.noise);
    if (!use_odometry) session.odometry.clear();
    pipeline::Progress progress = run.Track("scans", static_cast<std::int64_t>(session.scans.size()));
    survey::Track track = survey::TrackBlock(
        session, options, [&](std::size_t done) { progress.Advance(static_cast<std::int64_t>(done)); });
    if (track.odometry_lead_s != 0.0) run.Message(ToldLead(track.odometry_lead_s));
    if (engine == "particle-filter") {
      const survey::Answers answers =
          formats::ReadAnswers(answer_files, survey::ClockStamps(survey::StampsOfScans(session)));
      if (!answers.empty()) run.AddInput({"answers", formats::Sha256(formats::CanonicalText(answers))});
      track = Filter(session, track, answers, options, filter, cache, run);
    }
    formats::WriteTrack(output, track, survey::StampsOfScans(session), run.Provenance());
    for (const survey::TrackBreak& gap : survey::BreaksOf(track))
      run.Warn("the track may be broken at scan " + std::to_string(gap.scan.value) + ": " + gap.message);
    run.Message(Summary(track));
  });
}
