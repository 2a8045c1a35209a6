// SPDX-License-Identifier: Apache-2.0
//
// The container of ROS 1 bags, format 2.0 (wiki.ros.org/Bags/Format/2.0): records with named header fields, messages in
// chunks that may be compressed by bzip2 or LZ4. Read from front to back without the index, so a bag whose index is
// wrong, or missing because the recording was not closed, still gives its messages.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace formats {

struct BagConnection {
  std::string topic;
  std::string type;  // "sensor_msgs/LaserScan"
  std::string md5sum;
};

// `visit` gets each message of the bag in the order of recording: the connection and the serialized bytes. Returns a
// warning when the recording was not closed and its end is missing, else an empty text. DataError when the file is not
// such a bag or is damaged.
std::string ReadBagMessages(const std::filesystem::path& file,
                            const std::function<void(const BagConnection&, std::string_view)>& visit);

}  // namespace formats
