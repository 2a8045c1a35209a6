// SPDX-License-Identifier: Apache-2.0
//
// The pair of files of ROS map_server (raster_file.h).
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "formats/atomic_file.h"
#include "formats/map_writer.h"
#include "formats/raster_file.h"

namespace formats {

// folder/NAME.pgm, NAME.yaml and NAME_local.yaml; `remark` is a comment line of the yaml files, or empty.
class RosMap : public MapWriter {
 public:
  RosMap(const std::filesystem::path& folder, const std::string& name, const std::string& remark,
         const survey::RasterStrips& strips, const RasterLabel& label);
  void Take(int first_row, const survey::SiteRaster& rows) override;
  void Finish() override;

 private:
  void WriteYaml() const;

  std::filesystem::path folder_;
  std::string name_;
  std::string remark_;
  survey::SiteRaster frame_;
  RasterLabel label_;
  AtomicFile picture_;
  std::ofstream out_;
};

}  // namespace formats
