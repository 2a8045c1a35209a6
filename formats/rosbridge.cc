// SPDX-License-Identifier: Apache-2.0
#include "formats/rosbridge.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/json_text.h"
#include "formats/line_reader.h"

namespace formats {
namespace {

using nlohmann::json;
using survey::CellState;
using survey::SiteRaster;

// The thresholds of map.yaml.
constexpr float kOccupied = 0.65F;
constexpr float kFree = 0.196F;
constexpr int kStripRows = 256;
// A square hangs on one scan (survey/edits/anchoring.h), so it should not be larger (m).
constexpr double kSquare_m = 2.0;

CellState StateOf(float log_odds) {
  if (std::isnan(log_odds)) return CellState::kUnknown;
  const float probability = survey::ProbabilityFromLogOdds(log_odds);
  if (probability >= kOccupied) return CellState::kOccupied;
  return probability <= kFree ? CellState::kFree : CellState::kUnknown;
}

CellState StateOf(std::int8_t value) {
  if (value < 0) return CellState::kUnknown;
  if (static_cast<float>(value) >= 100.0F * kOccupied) return CellState::kOccupied;
  return static_cast<float>(value) <= 100.0F * kFree ? CellState::kFree : CellState::kUnknown;
}

const char* ValueOf(CellState state) {
  if (state == CellState::kUnknown) return "-1";
  return state == CellState::kOccupied ? "100" : "0";
}

json Stamp(RosVersion version) {
  if (version == RosVersion::kRos1) return {{"secs", 0}, {"nsecs", 0}};
  return {{"sec", 0}, {"nanosec", 0}};
}

json MessageWithoutData(const SiteRaster& frame, RosVersion version) {
  json header = {{"stamp", Stamp(version)}, {"frame_id", "map"}};
  if (version == RosVersion::kRos1) header["seq"] = 0;
  const json position = {{"x", static_cast<double>(frame.min_column) * frame.cell_size_m},
                         {"y", static_cast<double>(frame.min_row) * frame.cell_size_m},
                         {"z", 0.0}};
  const json orientation = {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}};
  return {{"header", header},
          {"info",
           {{"map_load_time", Stamp(version)},
            {"resolution", frame.cell_size_m},
            {"width", frame.width},
            {"height", frame.height},
            {"origin", {{"position", position}, {"orientation", orientation}}}}}};
}

// Strip by strip: memory does not grow with the map.
void WriteCells(const survey::RasterStrips& grid, std::ostream& out) {
  const char* separator = "";
  for (int first = 0; first < grid.frame.height; first += kStripRows) {
    const int height = std::min(kStripRows, grid.frame.height - first);
    for (const float log_odds : grid.read(grid.frame.min_row + first, height).log_odds) {
      out << separator << ValueOf(StateOf(log_odds));
      separator = ",";
    }
  }
}

void WriteTopic(const RosTopic& topic, RosVersion version, std::ostream& out) {
  const char* type = version == RosVersion::kRos1 ? "nav_msgs/OccupancyGrid" : "nav_msgs/msg/OccupancyGrid";
  out << JsonText(json{{"op", "advertise"}, {"topic", topic.name}, {"type", type}}) << "\n";
  std::string message = JsonText(MessageWithoutData(topic.grid.frame, version));
  message.pop_back();
  out << R"({"msg":)" << message << R"(,"data":[)";
  WriteCells(topic.grid, out);
  out << R"(]},"op":"publish","topic":)" << JsonText(json(topic.name)) << "}\n";
}

RosGrid GridOf(const json& message, const std::string& where) {
  try {
    const json& info = message.at("info");
    const json& position = info.at("origin").at("position");
    RosGrid grid;
    SiteRaster& frame = grid.frame;
    frame.cell_size_m = info.at("resolution").get<double>();
    frame.width = info.at("width").get<int>();
    frame.height = info.at("height").get<int>();
    if (!(frame.cell_size_m > 0) || frame.width <= 0 || frame.height <= 0)
      throw DataError(where + ": resolution, width and height must be positive");
    frame.min_column = std::llround(position.at("x").get<double>() / frame.cell_size_m);
    frame.min_row = std::llround(position.at("y").get<double>() / frame.cell_size_m);
    for (const json& value : message.at("data")) grid.cells.push_back(value.get<std::int8_t>());
    if (grid.cells.size() != static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height))
      throw DataError(where + ": data has " + std::to_string(grid.cells.size()) + " values for " +
                      std::to_string(frame.width) + " x " + std::to_string(frame.height) + " cells");
    return grid;
  } catch (const json::exception& error) {
    throw DataError(where + ": is not an OccupancyGrid: " + error.what());
  }
}

// Seconds and nanoseconds as ROS 1 or ROS 2 names them.
survey::StampNs StampOf(const json& stamp) {
  const bool ros1 = stamp.contains("secs");
  constexpr survey::StampNs kSecond = 1000000000;
  return stamp.at(ros1 ? "secs" : "sec").get<survey::StampNs>() * kSecond +
         stamp.at(ros1 ? "nsecs" : "nanosec").get<survey::StampNs>();
}

RosPose PoseOf(const json& message, const std::string& where) {
  try {
    const json& pose = message.at("pose").at("pose");
    const json& covariance = message.at("pose").at("covariance");
    const auto sigma = [&](std::size_t axis) { return std::sqrt(covariance.at(7 * axis).get<double>()); };
    const double z = pose.at("orientation").at("z").get<double>();
    const double w = pose.at("orientation").at("w").get<double>();
    return {StampOf(message.at("header").at("stamp")),
            {pose.at("position").at("x").get<double>(), pose.at("position").at("y").get<double>(),
             survey::NormalizeAngle(2.0 * std::atan2(z, w))},
            {sigma(0), sigma(1), sigma(5)}};
  } catch (const json::exception& error) {
    throw DataError(where + ": is not a PoseWithCovarianceStamped: " + error.what());
  }
}

// Rectangles of changed cells: runs of a row, joined with the same run of the row before.
class Rectangles {
 public:
  Rectangles(const SiteRaster& frame, CellState state) : frame_(frame) {
    largest_ = std::max(1, static_cast<int>(kSquare_m / frame.cell_size_m));
    edit_.kind = survey::EditKind::kCells;
    edit_.cells_state = state;
  }

  void Add(int row, int first, int last) {
    for (int begin = first; begin <= last; begin += largest_) {
      const std::pair run(begin, std::min(last, begin + largest_ - 1));
      const auto above = open_.find(run);
      const bool joins =
          above != open_.end() && above->second.second == row - 1 && row - above->second.first < largest_;
      if (joins) {
        above->second.second = row;
      } else {
        if (above != open_.end()) Close(run, above->second);
        open_[run] = {row, row};
      }
    }
  }

  std::optional<survey::MapEdit> Finish() {
    for (const auto& [run, rows] : open_) Close(run, rows);
    if (edit_.parts.empty()) return std::nullopt;
    return std::move(edit_);
  }

 private:
  void Close(const std::pair<int, int>& columns, const std::pair<int, int>& rows) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(frame_.cell_size_m / 2);
    const Eigen::Vector2d low = frame_.CentreOf(columns.first, rows.first) - half;
    const Eigen::Vector2d high = frame_.CentreOf(columns.second, rows.second) + half;
    edit_.parts.push_back({low, {high.x(), low.y()}, high, {low.x(), high.y()}});
  }

  const SiteRaster& frame_;
  int largest_;
  std::map<std::pair<int, int>, std::pair<int, int>> open_;  // columns; rows
  survey::MapEdit edit_;
};

void AddRuns(const RosGrid& edited, const SiteRaster& exported, int first_row, CellState state,
             Rectangles* rectangles) {
  for (int row = 0; row < exported.height; ++row) {
    const auto changed = [&](int column) {
      const CellState now = StateOf(edited.cells[edited.frame.Index(column, first_row + row)]);
      return now == state && now != StateOf(exported.At(column, row));
    };
    for (int column = 0; column < exported.width; ++column) {
      if (!changed(column)) continue;
      const int first = column;
      while (column + 1 < exported.width && changed(column + 1)) ++column;
      rectangles->Add(first_row + row, first, column);
    }
  }
}

}  // namespace

void WriteRosbridge(const std::filesystem::path& file, const std::vector<RosTopic>& topics, RosVersion version) {
  AtomicFile output(file);
  std::ofstream out(output.temporary(), std::ios::binary);
  for (const RosTopic& topic : topics) WriteTopic(topic, version, out);
  out.close();
  if (!out) throw DataError(file.string() + ": could not be written (disk full?)");
  output.Commit();
}

RosbridgeReply ReadRosbridge(const std::filesystem::path& file) {
  LineReader lines(file);
  RosbridgeReply reply;
  for (std::string_view text; lines.Next(&text);) {
    if (text.empty()) continue;
    const std::string where = file.string() + ":" + std::to_string(lines.line_number());
    const json message = JsonOrDiscarded(text);
    if (!message.is_object()) throw DataError(where + ": is not a message of rosbridge (JSON object)");
    if (message.value("op", json()) != "publish") continue;
    const json topic = message.value("topic", json());
    if (topic == "/map") reply.map = GridOf(message.value("msg", json()), where);
    if (topic == "/initialpose") reply.poses.push_back(PoseOf(message.value("msg", json()), where));
  }
  if (!reply.map && reply.poses.empty())
    throw DataError(file.string() + ": nothing was published on /map or /initialpose");
  return reply;
}

std::vector<survey::MapEdit> CellEdits(const RosGrid& edited, const survey::RasterStrips& exported,
                                       const std::string& where) {
  const SiteRaster& a = edited.frame;
  const SiteRaster& b = exported.frame;
  if (std::abs(a.cell_size_m - b.cell_size_m) > 1e-6 || a.min_column != b.min_column || a.min_row != b.min_row ||
      a.width != b.width || a.height != b.height)
    throw DataError(where + ": its grid is not that of the site's map as it is now (origin, size and resolution)");
  std::vector<survey::MapEdit> edits;
  for (const CellState state : survey::kCellStates) {
    Rectangles rectangles(b, state);
    for (int first = 0; first < b.height; first += kStripRows) {
      const int height = std::min(kStripRows, b.height - first);
      AddRuns(edited, exported.read(b.min_row + first, height), first, state, &rectangles);
    }
    if (auto edit = rectangles.Finish()) edits.push_back(*std::move(edit));
  }
  return edits;
}

}  // namespace formats
