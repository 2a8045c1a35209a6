// SPDX-License-Identifier: Apache-2.0
#include "formats/rosbridge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "tests/support/scratch_folder.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::CellState;

// 30 x 20 cells from (100, 200): free, a wall in row 5, unknown in column 0.
survey::SiteRaster Room() {
  survey::SiteRaster room{.cell_size_m = 0.1, .min_column = 1000, .min_row = 2000, .width = 30, .height = 20};
  room.log_odds.assign(600, -2.0F);
  for (int column = 0; column < 30; ++column) room.At(column, 5) = 2.0F;
  for (int row = 0; row < 20; ++row) room.At(0, row) = NAN;
  return room;
}

class RosbridgeTest : public testing::Test {
 protected:
  // The message of the map, as a client gets it.
  json Export(RosVersion version = RosVersion::kRos2) {
    WriteRosbridge(file_, {{"/map", survey::StripsOf(room_)}}, version);
    std::istringstream lines(ReadWholeFile(file_));
    std::string advertise;
    std::string publish;
    std::getline(lines, advertise);
    std::getline(lines, publish);
    type_ = json::parse(advertise)["type"];
    return json::parse(publish);
  }
  std::string Refusal(const std::string& text) {
    WriteFileAtomically(file_, text);
    try {
      CellEdits(ReadRosbridge(file_).map.value(), survey::StripsOf(room_), "back.jsonl");
      return "";
    } catch (const DataError& error) {
      return error.what();
    }
  }

  test_support::ScratchFolder scratch_;
  std::filesystem::path file_ = scratch_ / "back.jsonl";
  survey::SiteRaster room_ = Room();
  std::string type_;
};

TEST_F(RosbridgeTest, AClientReadsTheMap) {
  const json message = Export();
  EXPECT_EQ(message["op"], "publish");
  EXPECT_EQ(message["topic"], "/map");
  EXPECT_EQ(type_, "nav_msgs/msg/OccupancyGrid");
  const json& info = message["msg"]["info"];
  EXPECT_EQ(info["width"], 30);
  EXPECT_EQ(info["height"], 20);
  EXPECT_NEAR(info["origin"]["position"]["x"].get<double>(), 100.0, 1e-9);
  const json& data = message["msg"]["data"];
  ASSERT_EQ(data.size(), 600U);
  EXPECT_EQ(data[0], -1);
  EXPECT_EQ(data[1], 0);
  EXPECT_EQ(data[5 * 30 + 7], 100) << "row 5 from the south";
  EXPECT_EQ(Export(RosVersion::kRos1)["msg"]["header"]["stamp"]["secs"], 0);
  EXPECT_EQ(type_, "nav_msgs/OccupancyGrid");
}

TEST_F(RosbridgeTest, WhatAPersonChangedComesBackAsCells) {
  json message = Export();
  for (int row = 8; row < 11; ++row) {
    for (int column = 4; column < 9; ++column) message["msg"]["data"][row * 30 + column] = 100;
  }
  message["msg"]["data"][5 * 30 + 7] = 0;  // a hole in the wall
  message["msg"]["data"][6 * 30 + 7] = 3;  // as free as it was
  WriteFileAtomically(file_, Export().dump() + "\n" + message.dump() + "\n");
  const auto edits = CellEdits(ReadRosbridge(file_).map.value(), survey::StripsOf(room_), "back.jsonl");
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[0].cells_state, CellState::kOccupied);
  EXPECT_EQ(edits[0].parts.size(), 1U) << "one rectangle";
  EXPECT_EQ(edits[1].cells_state, CellState::kFree);
  survey::SiteRaster edited = room_;
  EXPECT_EQ(ApplyEdit(edits[0], &edited), 15);
  EXPECT_EQ(ApplyEdit(edits[1], &edited), 1);
  EXPECT_GT(edited.At(8, 10), 0.0F);
  EXPECT_LT(edited.At(7, 5), 0.0F);
}

TEST_F(RosbridgeTest, AnotherMapOrABrokenMessageIsRefused) {
  json moved = Export();
  moved["msg"]["info"]["origin"]["position"]["x"] = 101.0;
  json cut = Export();
  cut["msg"]["data"].erase(0);
  json other = Export();
  other["topic"] = "/costmap";
  EXPECT_NE(Refusal(moved.dump()).find("its grid is not that of the site's map"), std::string::npos);
  EXPECT_NE(Refusal(cut.dump()).find("back.jsonl:1: data has 599 values for 30 x 20 cells"), std::string::npos);
  EXPECT_NE(Refusal(other.dump()).find("nothing was published on /map or /initialpose"), std::string::npos);
  EXPECT_NE(Refusal("{\"op\":").find("back.jsonl:1: is not a message"), std::string::npos);
  EXPECT_NE(Refusal(R"({"op":"publish","topic":"/map","msg":{}})").find("is not an OccupancyGrid"), std::string::npos);
}

TEST_F(RosbridgeTest, APoseThatAPersonSetHasStampHeadingAndSigmas) {
  json pose = {{"op", "publish"}, {"topic", "/initialpose"}};
  pose["msg"]["header"]["stamp"] = {{"sec", 1007}, {"nanosec", 204000000}};
  pose["msg"]["pose"]["pose"]["position"] = {{"x", 500102.5}, {"y", 5600203.25}, {"z", 0}};
  pose["msg"]["pose"]["pose"]["orientation"] = {{"x", 0}, {"y", 0}, {"z", std::sqrt(0.5)}, {"w", std::sqrt(0.5)}};
  std::vector<double> covariance(36, 0.0);
  covariance[0] = covariance[7] = 0.01;
  covariance[35] = 0.0064;
  pose["msg"]["pose"]["covariance"] = covariance;
  WriteFileAtomically(file_, pose.dump() + "\n");
  const RosbridgeReply reply = ReadRosbridge(file_);
  EXPECT_FALSE(reply.map);
  ASSERT_EQ(reply.poses.size(), 1U);
  EXPECT_EQ(reply.poses[0].stamp_ns, 1007204000000);
  EXPECT_NEAR(reply.poses[0].site_from_robot.theta, std::acos(0.0), 1e-12);
  EXPECT_NEAR((reply.poses[0].sigma - Eigen::Vector3d(0.1, 0.1, 0.08)).norm(), 0.0, 1e-12);
  pose["msg"]["pose"].erase("covariance");
  EXPECT_NE(Refusal(pose.dump()).find("is not a PoseWithCovarianceStamped"), std::string::npos);
}

}  // namespace
}  // namespace formats
