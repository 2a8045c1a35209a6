// SPDX-License-Identifier: Apache-2.0
//
// plumbline-show: any artefact as text on standard output.
#include <iostream>

#include "formats/artefact_text.h"
#include "pipeline/stage.h"

int main(int argc, char** argv) {
  pipeline::Stage stage("show", "Print an artefact as text.",
                        "plumbline show work/B1/solution.sqlite --trajectory tum > B1.tum");
  std::filesystem::path file;
  std::string trajectory;
  stage.Positional("FILE", &file, "artefact: .sqlite, .tif or .json");
  stage.Text("trajectory", &trajectory,
             "print the poses of all scans instead: t x y z qx qy qz qw, of a track (local frame) or solution (site "
             "frame)",
             {"tum"});
  return stage.Run(argc, argv, [&](pipeline::StageRun&) {
    std::ios::sync_with_stdio(false);
    if (trajectory.empty()) {
      formats::PrintArtefact(file, std::cout);
    } else {
      formats::PrintTumTrajectory(file, std::cout);
    }
  });
}
