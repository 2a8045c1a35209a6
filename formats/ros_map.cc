// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_map.h"

#include <cstdio>
#include <vector>

#include "formats/errors.h"
#include "formats/map_codes.h"
#include "formats/map_greys.h"
#include "formats/raster_crs.h"

namespace formats {
namespace {

std::string RosYaml(const survey::SiteRaster& raster, const std::string& image, const std::string& comment,
                    double origin_x, double origin_y) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "resolution: %.10g\norigin: [%.4f, %.4f, 0.0]\n", raster.cell_size_m, origin_x,
                origin_y);
  return comment + "image: " + image + "\nmode: trinary\n" + numbers +
         "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

}  // namespace

RosMap::RosMap(const std::filesystem::path& folder, const std::string& name, const std::string& remark,
               const survey::RasterStrips& strips, const RasterLabel& label)
    : folder_(folder),
      name_(name),
      remark_(remark),
      frame_(strips.frame),
      label_(label),
      picture_(folder / (name + ".pgm")),
      out_(picture_.temporary(), std::ios::binary) {
  out_ << "P5\n" << frame_.width << " " << frame_.height << "\n255\n";
}

void RosMap::Take(int, const survey::SiteRaster& rows) {
  const std::vector<std::uint8_t> greys = CodesFromNorth(rows, &survey::SiteRaster::log_odds, &RosGrey);
  out_.write(reinterpret_cast<const char*>(greys.data()), static_cast<std::streamsize>(greys.size()));
}

void RosMap::Finish() {
  out_.close();
  if (!out_) throw DataError((folder_ / (name_ + ".pgm")).string() + ": could not be written (disk full?)");
  picture_.Commit();
  WriteYaml();
}

void RosMap::WriteYaml() const {
  const std::string image = name_ + ".pgm";
  const double origin_x = static_cast<double>(frame_.min_column) * frame_.cell_size_m;
  const double origin_y = static_cast<double>(frame_.min_row) * frame_.cell_size_m;
  const std::string crs = "# " + CrsNameOfLabel(label_) + "; x east, y north, metres\n" + remark_;
  WriteFileAtomically(folder_ / (name_ + ".yaml"),
                      RosYaml(frame_, image,
                              crs +
                                  "# origin: lower left corner in site coordinates. Tools that keep positions as "
                                  "32-bit floats: use " +
                                  name_ + "_local.yaml.\n",
                              origin_x, origin_y));
  char offset[128];
  std::snprintf(offset, sizeof offset, ", lower left corner at 0 0: site = local + (%.4f, %.4f)\n", origin_x, origin_y);
  WriteFileAtomically(folder_ / (name_ + "_local.yaml"),
                      RosYaml(frame_, image, crs + "# the picture of " + name_ + ".yaml" + offset, 0, 0));
}

}  // namespace formats
