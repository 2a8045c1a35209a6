// SPDX-License-Identifier: Apache-2.0
//
// Field data of a building that does not exist, with the exact truth: see survey/simulation/scenario.h.
#include <tbb/parallel_for.h>

#include <mutex>

#include "formats/field_csv.h"
#include "formats/scenario_picture.h"
#include "formats/scenario_route.h"
#include "formats/scenario_toml.h"
#include "formats/simulated_site.h"
#include "pipeline/stage.h"
#include "survey/simulation/planned_block.h"

namespace {

namespace fs = std::filesystem;

// Progress over all blocks and threads.
class Counter {
 public:
  explicit Counter(pipeline::Progress* progress) : progress_(progress) {}
  void Add(std::int64_t scans) {
    const std::scoped_lock lock(mutex_);
    done_ += scans;
    progress_->Advance(done_);
  }

 private:
  pipeline::Progress* progress_;
  std::mutex mutex_;
  std::int64_t done_ = 0;
};

void WriteBlock(const fs::path& output, const survey::Scenario& scenario, const survey::BlockRoute& block,
                const survey::RayCaster& building, const survey::RoutePlan& plan, Counter* counter) {
  const survey::Trajectory& trajectory = *plan.trajectory;
  const survey::SimulatedLidar lidar(scenario, block, building, trajectory);
  const std::vector<survey::Scan> scans =
      survey::SimulateScans(lidar, [&](std::int64_t added) { counter->Add(added); });

  const fs::path folder = output / "blocks" / block.name;
  formats::WriteScansCsv(folder / "scans.csv", survey::GeometryOf(scenario.lidar), scans);
  formats::WriteImuCsv(folder / "imu.csv", survey::SimulateImu(scenario, block, trajectory));
  formats::WriteOdometryCsv(folder / "odometry.csv", survey::SimulateOdometry(scenario, block, trajectory));
  formats::WriteMarksCsv(folder / "marks.csv", survey::MarksOfRoute(plan));

  const Eigen::Vector3d site_from_plan(scenario.origin_in_site.x(), scenario.origin_in_site.y(), scenario.elevation_m);
  std::vector<formats::TimedPose> truth;
  for (const survey::Scan& scan : scans)
    truth.push_back({scan.stamp_ns,
                     Eigen::Translation3d(site_from_plan) * trajectory.PlanFromLidar(survey::Seconds(scan.stamp_ns))});
  formats::WriteTum(output / "truth" / (block.name + ".tum"), truth);
}

void WriteSurvey(const fs::path& output, const survey::Scenario& scenario, const survey::RayCaster& building) {
  formats::WriteControlCsv(output / "control" / "points.csv", survey::SurveyControl(scenario));
  formats::WriteFeaturesCsv(output / "control" / "features.csv", survey::SurveyFeatures(scenario),
                            scenario.feature_sigma_m);
  std::vector<formats::TruePlace> points;
  for (const survey::LandmarkPoint& point : scenario.points)
    points.push_back({point.name, scenario.SiteOf(point.position)});
  formats::WriteTruePlacesCsv(output / "truth" / "points.csv", points);
  std::vector<formats::TruePlace> features;
  for (const survey::FeaturePoint& feature : scenario.features)
    features.push_back({feature.name, scenario.SiteOf(feature.position)});
  formats::WriteTruePlacesCsv(output / "truth" / "features.csv", features);
  formats::WriteTargetsCsv(output / "reference" / "targets.csv", survey::SurveyTargets(scenario),
                           scenario.control_sigma_m, scenario.reference.sphere_radius_m);
  formats::WritePly(output / "reference" / "cloud.ply", survey::SimulateReferenceCloud(scenario, building));
}

void WritePicture(const fs::path& file, const survey::Scenario& scenario, const survey::FloorPlan& plan,
                  const std::vector<survey::RoutePlan>& routes) {
  std::vector<formats::DrawnRoute> drawn;
  for (std::size_t i = 0; i < routes.size(); ++i) {
    const survey::Trajectory& trajectory = *routes[i].trajectory;
    drawn.push_back({.name = scenario.blocks[i].name});
    for (double time = trajectory.start_s(); time <= trajectory.end_s(); time += 0.1)
      drawn.back().way.push_back(trajectory.PlanarPlanFromLidar(time).Translation());
  }
  formats::WriteScenarioPicture(file, scenario, plan, drawn);
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("simulate", "Make the field data of a scenario: raw logs, control, reference and truth.",
                        "plumbline-simulate --scenario examples/parking-garage/small.toml --output garage");
  fs::path scenario_file;
  fs::path output;
  fs::path picture;
  std::int64_t seed = -1;
  stage.Input("scenario", &scenario_file, "scenario to simulate (TOML)");
  stage.Output("output", &output, "folder for blocks/, control/, reference/ and truth/");
  stage.OptionalOutput("picture", &picture, "picture of the plan with routes and points (PNG)");
  stage.Option("seed", &seed, "replaces the scenario's seed (-1: keep it)", {.min = -1});

  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    survey::Scenario scenario = formats::ReadScenario(scenario_file);
    if (seed >= 0) scenario.seed = static_cast<std::uint64_t>(seed);
    const survey::FloorPlan plan = survey::BuildFloorPlan(scenario);
    const survey::RayCaster building(plan);
    std::vector<survey::RoutePlan> routes;
    for (const survey::BlockRoute& block : scenario.blocks)
      routes.push_back(formats::DrivableRoute(scenario_file, scenario, block, building));

    std::int64_t total = 0;
    for (std::size_t i = 0; i < routes.size(); ++i)
      total += survey::SimulatedLidar(scenario, scenario.blocks[i], building, *routes[i].trajectory).num_scans();
    pipeline::Progress progress = run.Track("scans", total);
    Counter counter(&progress);
    if (!picture.empty()) WritePicture(picture, scenario, plan, routes);
    WriteSurvey(output, scenario, building);
    tbb::parallel_for(std::size_t{0}, routes.size(), [&](std::size_t i) {
      WriteBlock(output, scenario, scenario.blocks[i], building, routes[i], &counter);
    });
    for (std::size_t i = 0; i < routes.size(); ++i) {
      const double duration = routes[i].trajectory->end_s() - scenario.blocks[i].start_s;
      run.Message("block " + scenario.blocks[i].name + ": " + std::to_string(std::lround(routes[i].length_m)) +
                  " m in " + std::to_string(std::lround(duration)) + " s, " + std::to_string(routes[i].stops.size()) +
                  " marks");
    }
  });
}
