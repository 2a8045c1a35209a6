// SPDX-License-Identifier: Apache-2.0
#include "formats/vector_objects.h"

#include <cstdio>

#include "formats/atomic_file.h"

namespace formats {
namespace {

std::string PointsOf(const std::vector<Eigen::Vector2d>& ring, const Eigen::Vector2d& corner) {
  std::string text;
  for (const Eigen::Vector2d& p : ring) {
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "%s%.3f, %.3f", text.empty() ? "" : ", ", p.x() - corner.x(),
                  p.y() - corner.y());
    text += numbers;
  }
  return "[" + text + "]";
}

}  // namespace

void WriteVectorObjects(const std::filesystem::path& file, const std::vector<survey::MapEdit>& forbidden,
                        const survey::SiteRaster& frame) {
  const Eigen::Vector2d corner(static_cast<double>(frame.min_column) * frame.cell_size_m,
                               static_cast<double>(frame.min_row) * frame.cell_size_m);
  std::string names;
  std::string shapes;
  for (const survey::MapEdit& area : forbidden) {
    const std::string name = "forbidden_" + std::to_string(&area - forbidden.data());
    names += (names.empty() ? "\"" : ", \"") + name + "\"";
    shapes += "    " + name + ":  # edit " + area.uid + "\n      type: \"polygon\"\n      frame_id: \"map\"\n" +
              "      closed: true\n      value: 100\n      points: " + PointsOf(area.parts.front(), corner) + "\n";
  }
  char resolution[32];
  std::snprintf(resolution, sizeof resolution, "%.10g", frame.cell_size_m);
  WriteFileAtomically(file,
                      "# Forbidden areas; coordinates as in map_local.yaml\nvector_object_server:\n"
                      "  ros__parameters:\n    global_frame_id: \"map\"\n    resolution: " +
                          std::string(resolution) + "\n    default_value: 0\n    overlay_type: 1\n    shapes: [" +
                          names + "]\n" + shapes);
}

}  // namespace formats
