// SPDX-License-Identifier: Apache-2.0
#include "formats/scenario_toml.h"

#include <map>
#include <numbers>
#include <set>

#include "formats/toml_section.h"
#include "survey/simulation/floor_plan.h"

namespace formats {
namespace {

using Eigen::Vector2d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDegreePerHour = kDegree / 3600.0;
constexpr double kMilligal = 1e-5;  // m/s2

void ReadBuilding(TomlSection* root, survey::Scenario* scenario) {
  for (TomlSection& section : root->Tables("wall")) {
    survey::Wall wall{.line = section.RequiredLine("line", 2)};
    section.Number("thickness-m", &wall.thickness_m, {0.02, 5.0});
    section.Bool("closed", &wall.closed);
    section.Finish();
    scenario->walls.push_back(std::move(wall));
  }
  for (TomlSection& section : root->Tables("glass")) {
    survey::Glass glass{.line = section.RequiredLine("line", 2)};
    section.Number("response", &glass.response, {0.0, 1.0});
    section.Finish();
    scenario->glass.push_back(std::move(glass));
  }
  for (TomlSection& section : root->Tables("pillar")) {
    survey::Pillar pillar{.name = section.RequiredText("name"), .centre = section.RequiredPoint("at")};
    section.Number("size-m", &pillar.size_m, {0.05, 5.0});
    section.Bool("round", &pillar.round);
    section.Finish();
    scenario->pillars.push_back(std::move(pillar));
  }
  for (TomlSection& section : root->Tables("pillar-grid")) {
    survey::PillarGrid grid{.first = section.RequiredPoint("first"), .step = section.RequiredPoint("step")};
    section.Text("prefix", &grid.prefix);
    section.Integer("columns", &grid.columns, {1, 600});
    section.Integer("rows", &grid.rows, {1, 600});
    section.Number("size-m", &grid.size_m, {0.05, 5.0});
    section.Bool("round", &grid.round);
    section.Texts("without", &grid.without);
    section.Finish();
    scenario->pillar_grids.push_back(std::move(grid));
  }
  for (TomlSection& section : root->Tables("car")) {
    survey::Car car{.centre = section.RequiredPoint("at")};
    section.Number("heading-deg", &car.heading_rad, {-360, 360}, kDegree);
    section.Number("length-m", &car.length_m, {1.0, 20.0});
    section.Number("width-m", &car.width_m, {1.0, 4.0});
    section.Finish();
    scenario->cars.push_back(car);
  }
  std::set<std::string> rows;
  for (TomlSection& section : root->Tables("parking-row")) {
    survey::ParkingRow row{
        .name = section.RequiredText("name"), .from = section.RequiredPoint("from"), .to = section.RequiredPoint("to")};
    if (!rows.insert(row.name).second) section.Fail("name = \"" + row.name + "\": there is another row of this name");
    section.Point("step", &row.step);
    section.Integer("columns", &row.columns, {1, 600});
    section.Integer("rows", &row.rows, {1, 600});
    section.Texts("without", &row.without);
    section.Number("stall-width-m", &row.stall_width_m, {2.0, 5.0});
    section.Number("occupancy", &row.occupancy, {0.0, 1.0});
    section.Finish();
    if ((row.to - row.from).norm() < row.stall_width_m) section.Fail("is shorter than one stall");
    scenario->parking_rows.push_back(std::move(row));
  }
  for (TomlSection& section : root->Tables("person")) {
    survey::Person person{.path = section.RequiredLine("path", 2)};
    section.Number("speed-m-s", &person.speed_m_s, {0.0, 3.0});
    section.Number("radius-m", &person.radius_m, {0.05, 1.0});
    section.Finish();
    scenario->people.push_back(std::move(person));
  }
}

void ReadLidar(TomlSection section, survey::LidarSpec* lidar) {
  section.Number("rate-hz", &lidar->rate_hz, {1.0, 200.0});
  section.Integer("beams", &lidar->num_beams, {2, 20000});
  section.Number("field-of-view-deg", &lidar->field_of_view_rad, {10.0, 360.0}, kDegree);
  section.Number("time-increment-s", &lidar->time_increment_s, {0.0, 0.01});
  section.Number("range-min-m", &lidar->range_min_m, {0.01, 5.0});
  section.Number("range-max-m", &lidar->range_max_m, {5.0, 300.0});
  section.Number("near-sigma-m", &lidar->near_sigma_m, {0.0, 1.0});
  section.Number("far-sigma-m", &lidar->far_sigma_m, {0.0, 1.0});
  section.Number("near-limit-m", &lidar->near_limit_m, {0.0, 300.0});
  section.Number("dropout-probability", &lidar->dropout_probability, {0.0, 1.0});
  section.Finish();
  if (lidar->time_increment_s * lidar->num_beams > 1.0 / lidar->rate_hz)
    section.Fail("beams x time-increment-s is longer than one turn at rate-hz");
}

void ReadImu(TomlSection section, survey::ImuSpec* imu) {
  section.Number("rate-hz", &imu->rate_hz, {10.0, 2000.0});
  section.Number("gyro-bias-deg-h", &imu->gyro_bias_sigma_rad_s, {0.0, 1e5}, kDegreePerHour);
  section.Number("gyro-noise-deg-s-rthz", &imu->gyro_noise_rad_s_rthz, {0.0, 10.0}, kDegree);
  section.Number("accelerometer-bias-mgal", &imu->accelerometer_bias_sigma_m_s2, {0.0, 1e6}, kMilligal);
  section.Number("accelerometer-noise-m-s2-rthz", &imu->accelerometer_noise_m_s2_rthz, {0.0, 1.0});
  section.Number("latitude-deg", &imu->latitude_rad, {-90.0, 90.0}, kDegree);
  section.Finish();
}

void ReadOdometry(TomlSection section, survey::OdometrySpec* wheels) {
  section.Number("rate-hz", &wheels->rate_hz, {1.0, 1000.0});
  section.Number("scale-error", &wheels->scale_error, {-0.5, 0.5});
  section.Number("angular-drift-deg-per-m", &wheels->angular_drift_rad_per_m, {-10, 10}, kDegree);
  section.Number("angular-scale-error", &wheels->angular_scale_error, {-0.5, 0.5});
  section.Number("distance-noise-m-rtm", &wheels->distance_noise_m_rtm, {0.0, 1.0});
  section.Number("angular-noise-rad-rtrad", &wheels->angular_noise_rad_rtrad, {0.0, 1.0});
  section.Number("slips-per-m", &wheels->slips_per_m, {0.0, 1.0});
  section.Number("slip-length-m", &wheels->slip_length_m, {0.0, 10.0});
  section.Number("slip-loss", &wheels->slip_loss, {-1.0, 5.0});
  section.Number("slip-turn-deg-per-m", &wheels->slip_turn_rad_per_m, {0.0, 90.0}, kDegree);
  section.Finish();
}

void ReadCart(TomlSection section, survey::CartSpec* cart) {
  section.Number("speed-m-s", &cart->speed_m_s, {0.05, 5.0});
  section.Number("acceleration-m-s2", &cart->acceleration_m_s2, {0.05, 5.0});
  section.Number("turn-rate-deg-s", &cart->turn_rate_rad_s, {5.0, 360.0}, kDegree);
  section.Number("turn-acceleration-deg-s2", &cart->turn_acceleration_rad_s2, {5.0, 720.0}, kDegree);
  section.Number("corner-length-m", &cart->corner_length_m, {0.3, 20.0});
  section.Number("clearance-m", &cart->clearance_m, {0.2, 5.0});
  section.Number("floor-tilt-deg", &cart->floor_tilt_rad, {0.0, 0.6}, kDegree);  // beams must not meet the floor
  std::vector<double> mounting = {0.0, 0.0, 0.0};
  section.Numbers("body-from-lidar", &mounting, 3);
  cart->body_from_lidar = {mounting[0], mounting[1], mounting[2] * kDegree};
  section.Finish();
}

void ReadReference(TomlSection section, survey::ReferenceSpec* reference) {
  section.Line("stations", &reference->stations, 1);
  for (TomlSection& entry : section.Tables("targets")) {
    survey::SphereTarget target{.name = entry.RequiredText("name")};
    std::vector<double> centre;
    entry.Numbers("at", &centre, 3);
    if (centre.empty()) entry.Fail("at is missing");
    target.centre = {centre[0], centre[1], centre[2]};
    entry.Finish();
    reference->targets.push_back(std::move(target));
  }
  section.Number("sphere-radius-m", &reference->sphere_radius_m, {0.01, 1.0});
  section.Number("scanner-height-m", &reference->scanner_height_m, {0.1, 5.0});
  section.Number("ceiling-m", &reference->ceiling_m, {1.0, 50.0});
  section.Number("step-deg", &reference->step_rad, {0.01, 5.0}, kDegree);
  section.Number("target-step-deg", &reference->target_step_rad, {0.005, 1.0}, kDegree);
  section.Number("range-max-m", &reference->range_max_m, {1.0, 300.0});
  section.Number("noise-m", &reference->noise_m, {0.0, 0.1});
  std::vector<double> frame = {0.0, 0.0, 0.0, 0.0};
  section.Numbers("cloud-from-plan", &frame, 4);
  reference->scanner_from_plan = {frame[0], frame[1], frame[3] * kDegree};
  reference->scanner_from_plan_z_m = frame[2];
  section.Finish();
}

void ReadSurvey(TomlSection section, survey::Scenario* scenario) {
  section.Number("stop-s", &scenario->stop_s, {1.0, 600.0});
  section.Number("centring-sigma-m", &scenario->centring_sigma_m, {0.0, 1.0});
  section.Number("control-sigma-m", &scenario->control_sigma_m, {1e-4, 1.0});
  section.Number("feature-sigma-m", &scenario->feature_sigma_m, {1e-4, 1.0});
  std::set<std::string> names;
  for (TomlSection& entry : section.Tables("points")) {
    survey::LandmarkPoint point{.name = entry.RequiredText("name"), .position = entry.RequiredPoint("at")};
    if (!names.insert(point.name).second)
      entry.Fail("name = \"" + point.name + "\": there is another point of this name");
    std::string role = "control";
    entry.Word("role", &role, {"control", "check"});
    if (role == "check") point.role = survey::PointRole::kCheck;
    entry.Text("description", &point.description);
    entry.Finish();
    scenario->points.push_back(std::move(point));
  }
  const survey::FloorPlan plan = survey::BuildFloorPlan(*scenario);
  for (TomlSection& entry : section.Tables("features")) {
    survey::FeaturePoint feature{.name = entry.RequiredText("name")};
    if (!names.insert(feature.name).second)
      entry.Fail("name = \"" + feature.name + "\": there is another point or feature of this name");
    std::string kind = "corner";
    entry.Word("kind", &kind, {"corner", "pillar"});
    if (kind == "pillar") {
      feature.kind = survey::FeatureKind::kPillar;
      const std::string name = entry.RequiredText("pillar");
      const survey::Pillar* found = nullptr;
      for (const survey::Pillar& pillar : plan.pillars) {
        if (pillar.name == name) found = &pillar;
      }
      if (found == nullptr) entry.Fail("pillar = \"" + name + "\": there is no pillar of this name");
      feature.position = found->centre;
    } else {
      feature.position = entry.RequiredPoint("at");
      if (!survey::IsCorner(plan, feature.position)) entry.Fail("at: no two faces of walls or pillars meet there");
    }
    entry.Finish();
    scenario->features.push_back(std::move(feature));
  }
  section.Finish();
}

void ReadBlocks(TomlSection* root, survey::Scenario* scenario) {
  std::map<std::string, Vector2d> points;
  for (const survey::LandmarkPoint& point : scenario->points) points[point.name] = point.position;
  std::set<std::string> names;
  for (TomlSection& section : root->Tables("block")) {
    survey::BlockRoute block{.name = section.RequiredText("name")};
    if (!names.insert(block.name).second)
      section.Fail("name = \"" + block.name + "\": there is another block of this name");
    section.Number("start-s", &block.start_s, {0.0, 4e9});
    const toml::array* route = section.Array("route");
    if (route == nullptr) section.Fail("route is missing");
    for (const toml::node& node : *route) {
      if (!node.is_string()) {
        block.waypoints.push_back({.position = section.PointOf(node, "route")});
        continue;
      }
      const std::string name = *node.value<std::string>();
      const auto found = points.find(name);
      if (found == points.end()) section.Fail(&node, "route: there is no point \"" + name + "\"");
      block.waypoints.push_back({found->second, name});
    }
    section.Finish();
    scenario->blocks.push_back(std::move(block));
  }
  if (scenario->blocks.empty()) root->Fail("no [[block]]: nothing to drive");
}

}  // namespace

survey::Scenario ReadScenario(const std::filesystem::path& file) {
  const toml::table table = ParseTomlFile(file);
  TomlSection root(table, file, "");
  survey::Scenario scenario;
  scenario.name = root.RequiredText("name");
  root.Text("crs", &scenario.crs);
  root.Point("origin", &scenario.origin_in_site);
  root.Number("elevation-m", &scenario.elevation_m, {-500.0, 9000.0});
  int seed = 1;
  root.Integer("seed", &seed, {0, 2e9});
  scenario.seed = static_cast<std::uint64_t>(seed);
  ReadBuilding(&root, &scenario);
  ReadLidar(root.Table("lidar"), &scenario.lidar);
  ReadImu(root.Table("imu"), &scenario.imu);
  ReadOdometry(root.Table("odometry"), &scenario.odometry);
  ReadCart(root.Table("cart"), &scenario.cart);
  ReadReference(root.Table("reference"), &scenario.reference);
  ReadSurvey(root.Table("survey"), &scenario);
  ReadBlocks(&root, &scenario);
  root.Finish();
  return scenario;
}

}  // namespace formats
