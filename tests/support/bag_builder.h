// SPDX-License-Identifier: Apache-2.0
//
// Small ROS 1 bags for tests, byte by byte as the format lays them down.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace test_support {

template <typename T>
std::string Bytes(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

inline std::string Sized(const std::string& bytes) { return Bytes(static_cast<std::uint32_t>(bytes.size())) + bytes; }

inline std::string BagRecord(const std::vector<std::pair<std::string, std::string>>& fields, const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += Sized(name + "=" + value);
  return Sized(header) + Sized(data);
}

inline std::string BagOp(int op) { return Bytes(static_cast<std::uint8_t>(op)); }

inline std::string BagConnectionRecord(std::uint32_t id, const std::string& topic, const std::string& type,
                                       const std::string& md5sum) {
  const std::string description = Sized("topic=" + topic) + Sized("type=" + type) + Sized("md5sum=" + md5sum);
  return BagRecord({{"op", BagOp(7)}, {"conn", Bytes(id)}, {"topic", topic}}, description);
}

inline std::string BagMessageRecord(std::uint32_t id, const std::string& data) {
  return BagRecord({{"op", BagOp(2)}, {"conn", Bytes(id)}, {"time", Bytes(std::uint64_t{0})}}, data);
}

inline std::string BagChunk(const std::string& compression, std::size_t size, const std::string& data) {
  return BagRecord({{"op", BagOp(5)}, {"compression", compression}, {"size", Bytes(static_cast<std::uint32_t>(size))}},
                   data);
}

// `closed`: the recording was ended in order, so that the header points to an index.
inline std::string BagOf(const std::string& records, bool closed = true) {
  return "#ROSBAG V2.0\n" +
         BagRecord({{"op", BagOp(3)}, {"index_pos", Bytes(std::uint64_t{closed ? 4096U : 0U})}}, "") + records;
}

inline std::string RosHeader(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return Bytes(std::uint32_t{7}) + Bytes(seconds) + Bytes(nanoseconds) + Sized("frame");
}

inline std::string LaserScanMessage(std::uint32_t seconds, const std::vector<float>& ranges) {
  std::string message = RosHeader(seconds, 500);
  for (const float value : {-1.0F, 1.0F, 0.5F, 0.001F, 0.1F, 0.2F, 30.0F}) message += Bytes(value);
  message += Bytes(static_cast<std::uint32_t>(ranges.size()));
  for (const float range : ranges) message += Bytes(range);
  return message + Bytes(std::uint32_t{0});
}

inline constexpr const char* kLaserScanSum = "90c7ef2dc6895d81024acba2ac42f369";
inline constexpr const char* kMultiEchoSum = "6fefb0c6da89d7c8abe4b339f5c2f8fb";
inline constexpr const char* kImuSum = "6a62c6daae103f4ff57a132d6f95cec2";
inline constexpr const char* kOdometrySum = "cd5e73d190d741a2f92e81eda573aca7";

}  // namespace test_support
