// SPDX-License-Identifier: Apache-2.0
#include "formats/delivery_csv.h"

#include <set>
#include <utility>

#include "formats/atomic_file.h"
#include "formats/csv.h"
#include "formats/html.h"
#include "formats/text_numbers.h"

namespace formats {
namespace {

constexpr int kDecimals = 5;  // of coordinates, m

const std::vector<std::string> kControlHeader = {"point", "role", "easting", "northing"};
const std::vector<std::string> kPosesHeader = {"block", "t", "easting", "northing"};

std::string Row(const std::string& first, const std::string& second, const Eigen::Vector2d& position) {
  return first + "," + second + "," + Fixed(position.x(), kDecimals) + "," + Fixed(position.y(), kDecimals) + "\n";
}

survey::PointRole RoleOf(const CsvReader& csv, std::size_t field) {
  using survey::PointRole;
  for (const PointRole role : {PointRole::kControl, PointRole::kCheck, PointRole::kExcluded}) {
    if (csv.Text(field) == survey::Name(role)) return role;
  }
  csv.Fail(field, "must be control, check or excluded");
}

}  // namespace

std::vector<survey::DeliveredPoint> ReadDeliveredControl(const std::filesystem::path& file) {
  CsvReader csv(file);
  csv.ReadHeader(kControlHeader);
  std::vector<survey::DeliveredPoint> points;
  std::set<std::string> names;
  while (csv.NextRow()) {
    points.push_back({std::string(csv.Text(0)), RoleOf(csv, 1), {csv.Number(2), csv.Number(3)}});
    if (!names.insert(points.back().name).second) csv.Fail(0, "is there twice");
  }
  return points;
}

std::vector<survey::DeliveredPose> ReadDeliveredPoses(const std::filesystem::path& file) {
  CsvReader csv(file);
  csv.ReadHeader(kPosesHeader);
  std::vector<survey::DeliveredPose> poses;
  std::set<std::pair<std::string, survey::StampNs>> known;
  while (csv.NextRow()) {
    poses.push_back({std::string(csv.Text(0)), csv.Stamp(1), {csv.Number(2), csv.Number(3)}});
    if (!known.emplace(poses.back().block, poses.back().stamp_ns).second) csv.Fail(1, "is there twice for this block");
  }
  return poses;
}

void WriteDeliveredControl(const std::filesystem::path& file, const std::vector<survey::DeliveredPoint>& points) {
  std::string text =
      "# Written by `plumbline deliver`: control at the last delivery (m).\npoint,role,easting,northing\n";
  for (const survey::DeliveredPoint& point : points) {
    text += Row(point.name, std::string(survey::Name(point.role)), point.position);
  }
  WriteFileAtomically(file, text);
}

void WriteDeliveredPoses(const std::filesystem::path& file, const std::vector<survey::DeliveredPose>& poses) {
  std::string text =
      "# Written by `plumbline deliver`: the platform at the last delivery (s, m).\nblock,t,easting,northing\n";
  for (const survey::DeliveredPose& pose : poses) text += Row(pose.block, StampText(pose.stamp_ns), pose.position);
  WriteFileAtomically(file, text);
}

std::vector<survey::DeliveredPoint> PointsOfDelivery(const survey::ControlNetwork& network) {
  std::vector<survey::DeliveredPoint> points;
  for (const survey::ControlPoint& point : network.points) {
    if (point.role != survey::PointRole::kTie) points.push_back({point.name, point.role, point.position_in_site});
  }
  return points;
}

std::vector<survey::DeliveredPose> PosesOfDelivery(const std::string& block, const survey::Solution& solution,
                                                   const std::vector<survey::ScanStamp>& stamps, double spacing_m) {
  std::vector<survey::DeliveredPose> poses;
  if (!solution.tied) return poses;
  for (std::size_t i = 0; i < solution.scans.size(); ++i) {
    const Eigen::Vector2d position = solution.scans[i].site_from_scan.Translation();
    if (!poses.empty() && (position - poses.back().position).norm() < spacing_m) continue;
    poses.push_back({block, stamps[i].clock_ns, position});
  }
  return poses;
}

}  // namespace formats
