// SPDX-License-Identifier: Apache-2.0
//
// plumbline-ingest: raw field files of one block become its session: one clock, SI units, checked.
#include <cstdio>
#include <numbers>

#include "formats/artefacts.h"
#include "formats/digest.h"
#include "formats/feedback_files.h"
#include "formats/field_csv.h"
#include "formats/field_data.h"
#include "pipeline/stage.h"
#include "survey/edits/masked_beams.h"
#include "survey/inertial/motion_checks.h"
#include "survey/sensors/stuck_odometry.h"

namespace {

namespace fs = std::filesystem;

struct Mounting {
  std::optional<double> lidar_x_m;
  std::optional<double> lidar_y_m;
  std::optional<double> lidar_yaw_deg;
};

void DeclareOptions(pipeline::Stage* stage, Mounting* mounting, survey::SensorSetup* setup,
                    formats::FieldDataOptions* options) {
  const std::string otherwise = "; default: as the log says, or 0";
  stage->Option("lidar-x-m", &mounting->lidar_x_m, "lidar ahead of the platform's origin (m)" + otherwise);
  stage->Option("lidar-y-m", &mounting->lidar_y_m, "lidar to the left of the platform's origin (m)" + otherwise);
  stage->Option("lidar-yaw-deg", &mounting->lidar_yaw_deg, "lidar turned to the left (deg)" + otherwise,
                {.min = -360, .max = 360});
  stage->Option("mark-dx-m", &setup->mark_in_lidar.x(), "the marked place ahead of the lidar's centre (m)");
  stage->Option("mark-dy-m", &setup->mark_in_lidar.y(), "the marked place to the left of the lidar's centre (m)");
  stage->Option("range-min-m", &options->range_min_m, "ranges below tell nothing (m); default: as the log says",
                {.min = 0.0});
  stage->Option("range-max-m", &options->range_max_m,
                "ranges beyond came back from nothing (m); default: as the log says", {.min = 0.1});
  stage->Option("range-sigma-m", &setup->range_sigma_m, "noise of one range, 1 sigma (m)", {.min = 1e-4, .max = 1.0});
  stage->Option("mark-sigma-m", &setup->mark_sigma_m, "centring over a point, 1 sigma per axis (m)",
                {.min = 1e-5, .max = 1.0});
  stage->Option("scan-topic", &options->scan_topic, "scans to read: topic of a bag, or message of a CARMEN log");
  stage->Option("imu-topic", &options->imu_topic, "IMU topic of a bag");
  stage->Option("odometry-topic", &options->odometry_topic, "odometry topic of a bag");
}

survey::Pose2 BodyFromLidar(const Mounting& given, const std::optional<survey::Pose2>& told) {
  const survey::Pose2 start = told.value_or(survey::Pose2());
  return {given.lidar_x_m.value_or(start.x), given.lidar_y_m.value_or(start.y),
          given.lidar_yaw_deg ? survey::NormalizeAngle(*given.lidar_yaw_deg * std::numbers::pi / 180.0) : start.theta};
}

// Throws the first fault; marks by their row.
void RequireSound(const survey::Session& session, const std::vector<fs::path>& raw_files, const fs::path& marks_file,
                  const std::vector<int>& mark_rows) {
  std::vector<survey::SessionFault> faults = survey::CheckSession(session);
  if (faults.empty()) faults = survey::CheckMotionSensors(session);
  if (faults.empty()) return;
  const survey::SessionFault& first = faults.front();
  std::string where;
  if (first.part == survey::SessionPart::kMarks) {
    where = marks_file.string() + ":" + std::to_string(mark_rows[first.index]);
  } else {
    for (const fs::path& file : raw_files) where += (where.empty() ? "" : ", ") + file.string();
  }
  const std::string more = faults.size() > 1 ? " (and " + std::to_string(faults.size() - 1) + " more faults)" : "";
  throw formats::DataError(where + ": " + first.message + more);
}

std::string Summary(const survey::Session& session, std::size_t num_warnings) {
  const double seconds = survey::Seconds(session.scans.back().stamp_ns - session.scans.front().stamp_ns);
  char text[240];
  std::snprintf(text, sizeof text,
                "%zu scans in %.1f s (%.1f Hz), %zu IMU samples, %zu odometry samples, %zu marks, %zu warnings",
                session.scans.size(), seconds,
                seconds > 0 ? static_cast<double>(session.scans.size() - 1) / seconds : 0.0, session.imu.size(),
                session.odometry.size(), session.marks.size(), num_warnings);
  return text;
}

void DropMasked(const fs::path& masks_file, survey::Session* session, pipeline::StageRun& run) {
  const std::vector<survey::MaskedBeams> beams = formats::ReadMasks(masks_file);
  if (beams.empty()) return;
  run.AddInput({"masks", formats::Sha256(formats::CanonicalText(beams))});
  run.Message(std::to_string(survey::DropBeams(beams, session)) + " returns were masked by people");
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("ingest", "Read and check the raw field data of a block.",
                        "plumbline ingest --raw blocks/B1/raw/field.log --marks blocks/B1/marks.csv --output "
                        "work/B1/session.sqlite");
  std::vector<fs::path> raw_files;
  fs::path marks_file;
  fs::path masks_file;
  fs::path output;
  Mounting mounting;
  survey::Session session;
  formats::FieldDataOptions options;
  stage.Inputs("raw", &raw_files, "*.log, *.clf (CARMEN), *.bag (ROS 1), scans.csv, imu.csv, odometry.csv", true);
  stage.OptionalInput("marks", &marks_file, "marks.csv: when the platform stood on which point",
                      pipeline::Content::kTextWithoutComments);
  stage.OptionalInput("masks", &masks_file, "masks.json: returns that people masked", pipeline::Content::kParsed);
  stage.Output("output", &output, "session.sqlite to write");
  DeclareOptions(&stage, &mounting, &session.setup, &options);
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    formats::FieldData data;
    for (const fs::path& file : raw_files) formats::AddFieldData(formats::ReadFieldData(file, options), file, &data);
    session.setup.body_from_lidar = BodyFromLidar(mounting, data.body_from_lidar);
    session.geometries = std::move(data.geometries);
    session.scans = std::move(data.scans);
    session.imu = std::move(data.imu);
    session.odometry = std::move(data.odometry);
    std::vector<int> mark_rows;
    if (!marks_file.empty()) session.marks = formats::ReadMarksCsv(marks_file, &mark_rows);
    RequireSound(session, raw_files, marks_file, mark_rows);
    if (!masks_file.empty()) DropMasked(masks_file, &session, run);

    std::vector<std::string> warnings = std::move(data.warnings);
    for (std::string& warning : survey::DropStuckOdometry(&session)) warnings.push_back(std::move(warning));
    for (std::string& warning : survey::SessionWarnings(session)) warnings.push_back(std::move(warning));
    for (std::string& warning : survey::MotionWarnings(session)) warnings.push_back(std::move(warning));
    for (const std::string& note : data.notes) run.Message(note);
    for (const std::string& warning : warnings) run.Warn(warning);
    formats::WriteSession(output, session, run.Provenance());
    run.Message(Summary(session, warnings.size()));
  });
}
