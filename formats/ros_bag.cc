// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_bag.h"

#include <cmath>
#include <map>

#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "formats/ros_bag_file.h"

namespace formats {
namespace {

using survey::StampNs;

// The messages as their definitions lay them out; the sum names the version of a definition.
constexpr const char* kLaserScan = "sensor_msgs/LaserScan 90c7ef2dc6895d81024acba2ac42f369";
constexpr const char* kMultiEchoLaserScan = "sensor_msgs/MultiEchoLaserScan 6fefb0c6da89d7c8abe4b339f5c2f8fb";
constexpr const char* kImu = "sensor_msgs/Imu 6a62c6daae103f4ff57a132d6f95cec2";
constexpr const char* kOdometry = "nav_msgs/Odometry cd5e73d190d741a2f92e81eda573aca7";

constexpr std::size_t kCovariance3 = 9 * sizeof(double);
constexpr std::size_t kQuaternion = 4 * sizeof(double);

double Finite(const char* field, double value) {
  if (!std::isfinite(value)) throw DataError(std::string(field) + ": must be a finite number");
  return value;
}

StampNs ReadHeader(ByteReader* bytes) {
  bytes->Read<std::uint32_t>();  // sequence number
  const auto seconds = bytes->Read<std::uint32_t>();
  const auto nanoseconds = bytes->Read<std::uint32_t>();
  bytes->Sized();  // frame
  return static_cast<StampNs>(seconds) * 1'000'000'000 + nanoseconds;
}

Eigen::Vector3d ReadVector(ByteReader* bytes, const char* field) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = Finite(field, bytes->Read<double>());
  return vector;
}

survey::ScanGeometry ReadGeometry(ByteReader* bytes) {
  survey::ScanGeometry geometry;
  geometry.angle_min_rad = Finite("angle_min", bytes->Read<float>());
  bytes->Read<float>();  // angle_max
  geometry.angle_increment_rad = Finite("angle_increment", bytes->Read<float>());
  geometry.time_increment_s = Finite("time_increment", bytes->Read<float>());
  bytes->Read<float>();  // scan_time
  geometry.range_min_m = Finite("range_min", bytes->Read<float>());
  geometry.range_max_m = Finite("range_max", bytes->Read<float>());
  geometry.num_beams = static_cast<int>(bytes->Read<std::uint32_t>());
  return geometry;
}

float ReadFirstEcho(ByteReader* bytes) {
  float first = survey::kNoReturn;
  const auto count = bytes->Read<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto echo = bytes->Read<float>();
    if (i == 0) first = echo;
  }
  return first;
}

// REP 117: +inf came back from nothing, -inf was too near, NaN is no measurement.
float Classified(float range, const survey::ScanGeometry& geometry) {
  if (std::isnan(range) || range < geometry.range_min_m) return survey::kInvalidRange;
  return range > geometry.range_max_m ? survey::kNoReturn : range;
}

// What the bag holds of one topic.
struct Topic {
  std::string type;
  std::size_t num_messages = 0;
  std::vector<survey::ScanGeometry> geometries;
  std::vector<survey::Scan> scans;
  std::vector<survey::ImuSample> imu;
  std::vector<survey::OdometrySample> odometry;
};

void AddScan(ByteReader bytes, bool multi_echo, const FieldDataOptions& options, Topic* topic) {
  const StampNs stamp = ReadHeader(&bytes);
  survey::ScanGeometry geometry = ReadGeometry(&bytes);
  const int most_beams = static_cast<int>(bytes.size() / sizeof(float));
  if (geometry.num_beams < 2 || geometry.num_beams > most_beams)
    throw DataError("wrong beam count: " + std::to_string(geometry.num_beams));
  geometry.range_min_m = options.range_min_m.value_or(geometry.range_min_m);
  geometry.range_max_m = options.range_max_m.value_or(geometry.range_max_m);
  if (geometry.angle_increment_rad == 0) throw DataError("angle_increment = 0: must not be 0");
  if (geometry.range_max_m <= geometry.range_min_m) throw DataError("range_max must exceed range_min");

  survey::Scan scan{.stamp_ns = stamp, .geometry = IndexOfGeometry(geometry, &topic->geometries)};
  for (int i = 0; i < geometry.num_beams; ++i)
    scan.ranges_m.push_back(Classified(multi_echo ? ReadFirstEcho(&bytes) : bytes.Read<float>(), geometry));
  topic->scans.push_back(std::move(scan));
}

void AddImu(ByteReader bytes, Topic* topic) {
  survey::ImuSample sample{.stamp_ns = ReadHeader(&bytes)};
  bytes.Bytes(kQuaternion + kCovariance3);
  sample.angular_rate_in_body = ReadVector(&bytes, "angular_velocity");
  bytes.Bytes(kCovariance3);
  sample.specific_force_in_body = ReadVector(&bytes, "linear_acceleration");
  topic->imu.push_back(sample);
}

void AddOdometry(ByteReader bytes, Topic* topic) {
  const StampNs stamp = ReadHeader(&bytes);
  bytes.Sized();  // child frame
  const Eigen::Vector3d position = ReadVector(&bytes, "pose.position");
  const auto x = bytes.Read<double>();
  const auto y = bytes.Read<double>();
  const auto z = bytes.Read<double>();
  const auto w = bytes.Read<double>();
  const double yaw = Finite("pose.orientation", std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)));
  topic->odometry.push_back({stamp, {position.x(), position.y(), yaw}});
}

bool IsOfInterest(const std::string& type) {
  for (const std::string_view known : {kLaserScan, kMultiEchoLaserScan, kImu, kOdometry}) {
    if (type == known.substr(0, known.find(' '))) return true;
  }
  return false;
}

void AddMessage(const BagConnection& connection, std::string_view bytes, const FieldDataOptions& options,
                std::map<std::string, Topic>* topics) {
  if (!IsOfInterest(connection.type)) return;
  Topic& topic = (*topics)[connection.topic];
  topic.type = connection.type;
  ++topic.num_messages;
  const std::string version = connection.type + " " + connection.md5sum;
  try {
    if (version == kLaserScan || version == kMultiEchoLaserScan) {
      AddScan(ByteReader(bytes), version == kMultiEchoLaserScan, options, &topic);
    } else if (version == kImu) {
      AddImu(ByteReader(bytes), &topic);
    } else if (version == kOdometry) {
      AddOdometry(ByteReader(bytes), &topic);
    } else {
      throw DataError("another version of its type (" + version + ")");
    }
  } catch (const std::runtime_error& problem) {  // DataError and EndOfData
    throw DataError(connection.topic + " message " + std::to_string(topic.num_messages) + ": " + problem.what());
  }
}

// The topic of a kind to read: the wanted one or the only one; null when the bag has none.
Topic* ChooseTopic(const std::string& file, std::map<std::string, Topic>* topics, const std::string& kind,
                   const std::string& wanted, bool (*is_of_kind)(const Topic&)) {
  std::string names;
  int count = 0;
  Topic* chosen = nullptr;
  for (auto& [name, topic] : *topics) {
    if (!is_of_kind(topic)) continue;
    names += (names.empty() ? "" : ", ") + name;
    ++count;
    if (wanted.empty() || wanted == name) chosen = &topic;
  }
  if (!wanted.empty() && chosen == nullptr)
    throw DataError(file + ": " + kind + "-topic " + wanted + ": no such topic; the bag has " +
                    (names.empty() ? "none of its kind" : names));
  if (wanted.empty() && count > 1)
    throw DataError(file + ": several topics could be the " + kind + ": " + names + "; choose one with " + kind +
                    "-topic");
  return chosen;
}

}  // namespace

FieldData ReadRosBag(const std::filesystem::path& file, const FieldDataOptions& options) {
  std::map<std::string, Topic> topics;
  FieldData data;
  const std::string warning = ReadBagMessages(file, [&](const BagConnection& connection, std::string_view bytes) {
    AddMessage(connection, bytes, options, &topics);
  });
  if (!warning.empty()) data.warnings.push_back(warning);

  const std::string name = file.string();
  if (Topic* topic =
          ChooseTopic(name, &topics, "scan", options.scan_topic, [](const Topic& t) { return !t.scans.empty(); })) {
    data.scans = std::move(topic->scans);
    SortScans(name, &data);
    data.geometries = std::move(topic->geometries);
  }
  if (Topic* topic =
          ChooseTopic(name, &topics, "imu", options.imu_topic, [](const Topic& t) { return !t.imu.empty(); })) {
    data.imu = std::move(topic->imu);
    SortSamples("IMU", &data.imu, &data);
  }
  if (Topic* topic = ChooseTopic(name, &topics, "odometry", options.odometry_topic,
                                 [](const Topic& t) { return !t.odometry.empty(); })) {
    data.odometry = std::move(topic->odometry);
    SortSamples("odometry", &data.odometry, &data);
  }
  return data;
}

}  // namespace formats
