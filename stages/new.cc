// SPDX-License-Identifier: Apache-2.0
//
// plumbline-new: the folder of a new site. A program of its own, so that the front command starts without the libraries
// that look into control lists and coordinate systems.
#include <CLI/CLI.hpp>
#include <iostream>

#include "pipeline/graph_stages.h"
#include "pipeline/new_site.h"
#include "pipeline/program.h"

namespace {

int New(const std::vector<std::string>& arguments) {
  pipeline::NewSite request;
  std::vector<std::string> blocks;
  CLI::App app("Make a site's folder from field data and a control list.", "plumbline new");
  app.add_option("SITE", request.site, "folder to make");
  app.add_option("--crs", request.crs, "projected coordinate system of the control, e.g. EPSG:25832");
  app.add_option("--control", request.control, "control and check points, or observations (.csv .txt .xml .gkf .dat)");
  app.add_option("--control-order", request.control_order, "order of a control list without a header")
      ->check(CLI::IsMember({"pnezd", "penzd", "navvis"}));
  app.add_option("--features", request.features, "check features with independent coordinates (CSV)");
  app.add_option("--block", blocks, "field data of a block: a log, a bag, or a folder with its marks.csv")
      ->type_name("NAME=FILE|FOLDER");
  app.add_flag("--link", request.link, "link to the files instead of copying them");
  app.footer("Example:\n  plumbline new office --crs EPSG:25832 --control points.csv --block A=monday/");
  if (!pipeline::ParseArguments(arguments, &app)) return 0;
  for (const std::string& block : blocks) request.blocks.push_back(pipeline::BlockFromText(block));

  const pipeline::GraphStages stages = pipeline::AskStagesOfGraph({});
  for (const std::string& remark : pipeline::MakeSite(request, stages)) std::cerr << "plumbline: " << remark << "\n";
  std::cerr << "plumbline: made " << request.site.string() << "; go on with: plumbline run " << request.site.string()
            << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return pipeline::RunProgram([&] { return New({argv + 1, argv + argc}); });
}
