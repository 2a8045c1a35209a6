// SPDX-License-Identifier: Apache-2.0
#include "formats/certificate_changes.h"

#include "formats/html.h"

namespace formats {
namespace {

using survey::ControlChange;
using survey::PointFate;

std::string FateText(const ControlChange& change) {
  switch (change.fate) {
    case PointFate::kMoved:
      return "moved";
    case PointFate::kAdded:
      return "new";
    case PointFate::kRemoved:
      return "no longer listed";
    case PointFate::kOtherRole:
      return std::string(survey::Name(change.before->role)) + " &rarr; " + std::string(survey::Name(change.now->role));
  }
  return "";
}

std::string Place(const std::optional<survey::DeliveredPoint>& point, int axis) {
  return point ? Fixed(point->position(axis), 4) : kDash;
}

std::string ControlTable(const std::vector<ControlChange>& changes) {
  if (changes.empty()) return "<p>No control or check point changed.</p>\n";
  HtmlTable table({"point", "change", "old east (m)", "old north (m)", "new east (m)", "new north (m)", "dE", "dN",
                   "map dE", "map dN"},
                  2);
  for (const ControlChange& change : changes) {
    const bool compared = change.before && change.now;
    const auto map = [&](int axis) { return change.map_shift ? Millimetres((*change.map_shift)(axis)) : kDash; };
    table.Row({Escaped(change.name), FateText(change), Place(change.before, 0), Place(change.before, 1),
               Place(change.now, 0), Place(change.now, 1), compared ? Millimetres(change.shift.x()) : kDash,
               compared ? Millimetres(change.shift.y()) : kDash, map(0), map(1)});
  }
  return table.Text();
}

std::string BlockTable(const std::vector<survey::BlockChange>& blocks) {
  HtmlTable table({"block", "places compared", "mean dE", "mean dN", "RMS", "largest", "there: east (m)", "north (m)"},
                  1);
  for (const survey::BlockChange& block : blocks) {
    if (block.num_poses == 0) {
      table.Row({Escaped(block.name), "none: new, gone or recorded anew", kDash, kDash, kDash, kDash, kDash, kDash});
      continue;
    }
    table.Row({Escaped(block.name), std::to_string(block.num_poses), Millimetres(block.mean_shift.x()),
               Millimetres(block.mean_shift.y()), Millimetres(block.rms_shift), Millimetres(block.max_shift),
               Fixed(block.place_of_max.x(), 1), Fixed(block.place_of_max.y(), 1)});
  }
  return table.Text();
}

}  // namespace

std::string ChangesSection(const survey::DeliveryChanges& changes) {
  return "<h2>Changes since the last delivery</h2>\n<p class=\"note lead\">Shifts are now &minus; before, mm. map: "
         "what "
         "the adjusted platform did near the point.</p>\n" +
         ControlTable(changes.control) + "<h3>How far the maps moved</h3>" + BlockTable(changes.blocks);
}

}  // namespace formats
