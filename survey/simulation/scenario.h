// SPDX-License-Identifier: Apache-2.0
//
// What `simulate` is asked for: a building, a rig, routes, control and the errors of all of them. Coordinates are in
// the plan frame (x east, y north, m); site = plan + origin. Angles in radians, SI units throughout. The defaults of
// the rig are the equipment of [CN] section 3.1 (Hokuyo UTM-30LX-EW, Xsens MTi-G).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "survey/control/control_point.h"
#include "survey/features/feature.h"
#include "survey/geometry/pose2.h"

namespace survey {

using Polyline = std::vector<Eigen::Vector2d>;

// A wall of even thickness along its centre line.
struct Wall {
  Polyline line;
  double thickness_m = 0.3;
  bool closed = false;
};

// A pane gives a return with probability `response`; otherwise the beam passes.
struct Glass {
  Polyline line;
  double response = 0.15;
};

struct Pillar {
  std::string name;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double size_m = 0.6;  // side of the square or diameter
  bool round = false;
};

// Pillars named by column letter and row number from `first`: A1, B1, ..., A2, ...
struct PillarGrid {
  std::string prefix;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  int columns = 1;
  int rows = 1;
  double size_m = 0.6;
  bool round = false;
  std::vector<std::string> without;  // names left out
};

// A car at the height of the LiDAR: a box with rounded corners.
struct Car {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
};

// Stalls side by side along a line, each taken with a probability by a car across the line; cars that would touch a
// wall or a pillar are left out. The line may be repeated in columns and rows, named as in a PillarGrid.
struct ParkingRow {
  std::string name;  // names the random numbers, together with the column and row
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  int columns = 1;
  int rows = 1;
  double stall_width_m = 2.7;
  double occupancy = 0.6;
  std::vector<std::string> without;  // lines left out
};

// Somebody who walks to and fro along a path.
struct Person {
  Polyline path;
  double speed_m_s = 1.2;
  double radius_m = 0.25;
};

struct LidarSpec {
  double rate_hz = 40.0;
  int num_beams = 1081;
  double field_of_view_rad = 4.71238898038469;  // 270 degrees
  double time_increment_s = 0.025 / 1440.0;     // 0.25 degrees of a turn in 25 ms
  double range_min_m = 0.1;
  double range_max_m = 30.0;
  // The maker's +-30 mm to 10 m and +-50 mm beyond, read as three sigma.
  double near_sigma_m = 0.010;
  double far_sigma_m = 0.017;
  double near_limit_m = 10.0;
  double dropout_probability = 0.002;
};

struct ImuSpec {
  double rate_hz = 200.0;
  double gyro_bias_sigma_rad_s = 9.69627362219072e-4;  // 200 deg/h, turn-on bias of each axis
  double gyro_noise_rad_s_rthz = 8.72664625997165e-4;  // 0.05 deg/s/sqrt(Hz)
  double accelerometer_bias_sigma_m_s2 = 0.02;         // 2000 mGal, turn-on bias of each axis
  double accelerometer_noise_m_s2_rthz = 0.002;
  double latitude_rad = 0.882;  // for gravity and the Earth's rotation
};

struct OdometrySpec {
  double rate_hz = 50.0;
  double scale_error = 0.01;               // distances are measured too long by this part
  double angular_drift_rad_per_m = 0.003;  // of heading per metre driven
  double angular_scale_error = 0.01;       // turns are measured too large by this part
  double distance_noise_m_rtm = 0.005;     // per square root of metre driven
  double angular_noise_rad_rtrad = 0.01;   // per square root of radian turned
  double slips_per_m = 0.02;               // chance of a slip to begin, per metre
  double slip_length_m = 0.3;              // distance driven while slipping
  double slip_loss = 0.4;                  // part of the motion that the wheels add while slipping
  double slip_turn_rad_per_m = 0.03;       // false turn while slipping, either way
};

// Limits of the cart's motion. The route is the path of the LiDAR centre.
struct CartSpec {
  double speed_m_s = 1.0;
  double acceleration_m_s2 = 0.5;
  double turn_rate_rad_s = 0.8;
  double turn_acceleration_rad_s2 = 1.0;
  double corner_length_m = 2.0;  // how far before a waypoint the turn begins
  double clearance_m = 0.4;      // keeps this distance to everything that stands still
  Pose2 body_from_lidar;
  double floor_tilt_rad = 0.004;  // root mean square slope of the uneven floor
};

struct LandmarkPoint {
  std::string name;
  PointRole role = PointRole::kControl;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // truth
  std::string description;
};

// A corner (where two faces meet) or the centre of a pillar.
struct FeaturePoint {
  std::string name;
  FeatureKind kind = FeatureKind::kCorner;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

// A place the route goes through; with a point's name the cart stops there, its LiDAR over the point.
struct Waypoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  std::string point;
};

struct BlockRoute {
  std::string name;
  double start_s = 0.0;  // of the log's clock; also says where the people are
  std::vector<Waypoint> waypoints;
};

// A terrestrial scanner's work: its registered cloud lies in a frame of its own.
struct SphereTarget {
  std::string name;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // plan frame, z above the floor
};

struct ReferenceSpec {
  std::vector<Eigen::Vector2d> stations;
  std::vector<SphereTarget> targets;
  double sphere_radius_m = 0.0725;
  double scanner_height_m = 1.6;
  double ceiling_m = 2.6;
  double step_rad = 0.00174533;         // between the points of the building along a level line
  double target_step_rad = 0.00087266;  // around the spheres
  double range_max_m = 40.0;
  double noise_m = 0.002;
  Pose2 scanner_from_plan;  // turn and shift of the cloud's frame
  double scanner_from_plan_z_m = 0.0;
};

struct Scenario {
  std::string name;
  std::string crs;
  Eigen::Vector2d origin_in_site = Eigen::Vector2d::Zero();
  double elevation_m = 0.0;  // of the floor
  std::uint64_t seed = 1;

  std::vector<Wall> walls;
  std::vector<Glass> glass;
  std::vector<Pillar> pillars;
  std::vector<PillarGrid> pillar_grids;
  std::vector<Car> cars;
  std::vector<ParkingRow> parking_rows;
  std::vector<Person> people;

  LidarSpec lidar;
  ImuSpec imu;
  OdometrySpec odometry;
  CartSpec cart;

  double stop_s = 3.0;              // over a mark
  double centring_sigma_m = 0.003;  // of a mark, per axis
  double control_sigma_m = 0.003;   // of the surveyed coordinates, per axis
  double feature_sigma_m = 0.003;
  std::vector<LandmarkPoint> points;
  std::vector<FeaturePoint> features;
  std::vector<BlockRoute> blocks;
  ReferenceSpec reference;

  Eigen::Vector2d SiteOf(const Eigen::Vector2d& p_in_plan) const { return origin_in_site + p_in_plan; }
};

// What the random numbers are drawn for: changing one never reshuffles another.
enum class SimulationPurpose : std::uint32_t {
  kParking = 101,
  kFloor,
  kCentring,
  kControlSurvey,
  kFeatureSurvey,
  kRangeNoise,
  kRangeChance,
  kImuBias,
  kImuNoise,
  kOdometry,
  kSlip,
  kPeople,
  kReference,
  kTargetSurvey,
};

}  // namespace survey
