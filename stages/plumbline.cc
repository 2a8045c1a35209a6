// SPDX-License-Identifier: Apache-2.0
//
// The front command: `plumbline run|status|deliver`, and `plumbline STAGE ...` as git does it.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <thread>

#include "formats/errors.h"
#include "formats/requests_file.h"
#include "pipeline/deliver_site.h"
#include "pipeline/graph_stages.h"
#include "pipeline/nearest.h"
#include "pipeline/program.h"
#include "pipeline/site_config.h"
#include "pipeline/site_lock.h"
#include "pipeline/site_status.h"
#include "pipeline/stage.h"
#include "pipeline/stage_program.h"
#include "pipeline/subprocess.h"
#include "pipeline/words.h"

namespace {

namespace fs = std::filesystem;
using formats::UsageError;

constexpr const char* kHelp = R"(Plumbline makes georeferenced indoor maps from laser scans and a control network.

  plumbline new SITE --crs EPSG:25832 --control points.csv --block B1=field.log --block B2=folder/
                     make a site's folder from field data and a control list
  plumbline run SITE [-j N] [TARGET ...]
                     bring everything up to date, or a TARGET: a stage, a block, a file
  plumbline status SITE
                     what is done, what is stale and why, what failed
  plumbline review SITE
                     answer review requests and edit the map on a local page
  plumbline deliver SITE
                     note that the results were handed over: later certificates tell what changed since
  plumbline edits add|retire|list|checkout|accept SITE ...
                     what people want changed in the maps
  plumbline show FILE | check FILE
                     print or verify any result
  plumbline STAGE ...
                     run one stage by itself; `plumbline STAGE --help` explains it
  plumbline --graph  path of the make graph that a site's Makefile includes
  plumbline --version

Example:
  plumbline new office --control points.csv --block A=monday/ && plumbline run office -j 2
)";

using Arguments = std::vector<std::string>;

void CheckIsSite(const fs::path& site) {
  if (site.empty()) throw UsageError("SITE is required: the folder that `plumbline new` made");
  if (!fs::is_directory(site)) throw UsageError(site.string() + ": no such folder");
  if (!fs::exists(site / "Makefile") || !fs::exists(site / "site.toml")) {
    throw UsageError(site.string() +
                     ": no Makefile and site.toml in it, so it is not a site (plumbline new makes one)");
  }
}

// Files may be named as seen from here or as seen from the site.
std::string TargetInSite(const fs::path& site, const std::string& target) {
  if (target.find('/') == std::string::npos) return target;
  const fs::path from_site = fs::absolute(target).lexically_normal().lexically_relative(fs::canonical(site));
  const bool inside = !from_site.empty() && !from_site.string().starts_with("..");
  return inside ? from_site.string() : target;
}

// make says 2 for every failure; the logs know which.
int ExitStatusOfFailure(const fs::path& site, fs::file_time_type began, int make_status) {
  int worst = 0;
  if (fs::is_directory(site / "logs")) {
    for (const fs::directory_entry& log : fs::directory_iterator(site / "logs")) {
      if (log.last_write_time() < began) continue;
      worst = std::max(worst, pipeline::ReadLogEnd(log.path()).exit_status);
    }
  }
  return worst != 0 ? worst : make_status;
}

void PutOwnFolderFirstOnPath() {
  const char* path = std::getenv("PATH");
  setenv("PATH", (pipeline::OwnFolder().string() + (path != nullptr ? ":" + std::string(path) : "")).c_str(), 1);
}

int Run(const Arguments& arguments) {
  fs::path site;
  std::vector<std::string> targets;
  int jobs = 1;
  CLI::App app("Bring a site up to date.", "plumbline run");
  app.add_option("SITE", site, "the site's folder");
  app.add_option("TARGET", targets, "a stage's name, a block's name or a file; everything when none is given");
  app.add_option("-j,--jobs", jobs, "stages to run at once")->check(CLI::Range(1, 10000));
  app.footer("Example:\n  plumbline run office -j 2 out/site.tif");
  if (!pipeline::ParseArguments(arguments, &app)) return 0;
  CheckIsSite(site);
  // make will do this too; done here first, a mistake in the site's files is told without make's own words.
  pipeline::ConfigureSite(site, pipeline::AskStagesOfGraph(site / "work" / ".programs"));

  PutOwnFolderFirstOnPath();
  if (jobs > 1 && std::getenv("PLUMBLINE_THREADS") == nullptr) {
    const int cores = static_cast<int>(std::thread::hardware_concurrency());
    setenv("PLUMBLINE_THREADS", std::to_string(std::max(1, cores / jobs)).c_str(), 1);
  }
  Arguments make = {"make", "--no-print-directory", "-C", site.string()};
  if (jobs > 1) make.push_back("-j" + std::to_string(jobs));
  for (const std::string& target : targets) make.push_back(TargetInSite(site, target));
  const auto began = fs::file_time_type::clock::now() - std::chrono::milliseconds(20);  // coarser clock of files
  signal(SIGINT, [](int) {});  // Ctrl-C is for make and its stages (exec resets a handler); we tell the outcome
  const int status = pipeline::RunAndWait(make);
  if (status > 128) {
    std::cerr << "plumbline: make was stopped by signal " << status - 128 << "; run again to go on from here\n";
  }
  return status == 0 ? 0 : ExitStatusOfFailure(site, began, status);
}

// What waits for a person, by the last run.
std::string OpenRequests(const fs::path& site) {
  const fs::path list = site / "work" / "requests.jsonl";
  std::string text;
  if (!fs::exists(list)) return text;
  std::vector<formats::ListedBlock> blocks;
  try {
    blocks = formats::ReadReviewedBlocks(list);
  } catch (const formats::DataError& error) {  // of an older version perhaps: the next run writes it anew
    return error.what() + std::string("\n");
  }
  for (const formats::ListedBlock& block : blocks) {
    if (block.review.num_open == 0) continue;
    text += block.name + ": " + std::to_string(block.review.num_open) + " of " +
            std::to_string(block.review.num_requests) + " review requests have no answer (work/requests.jsonl)\n";
  }
  return text;
}

int Status(const Arguments& arguments) {
  fs::path site;
  CLI::App app("Say what is done, what is stale and why, what failed.", "plumbline status");
  app.add_option("SITE", site, "the site's folder");
  app.footer("Example:\n  plumbline status office");
  if (!pipeline::ParseArguments(arguments, &app)) return 0;
  CheckIsSite(site);
  PutOwnFolderFirstOnPath();
  std::cout << OpenRequests(site) << pipeline::StatusText(pipeline::SiteStatus(site, pipeline::ReadGraph(site)));
  return 0;
}

int Deliver(const Arguments& arguments) {
  fs::path site;
  CLI::App app("Note that the results were handed over: later certificates tell what changed since.",
               "plumbline deliver");
  app.add_option("SITE", site, "the site's folder");
  app.footer("Example:\n  plumbline deliver office && git -C office add delivered");
  if (!pipeline::ParseArguments(arguments, &app)) return 0;
  CheckIsSite(site);
  PutOwnFolderFirstOnPath();
  pipeline::DeliverSite(site);
  std::cerr << "plumbline: noted in " << (site / "delivered").string() << "\n";
  return 0;
}

// Called by plumbline.mk before anything else, in the site's folder.
int Configure(const Arguments& arguments) {
  std::string of_blocks;
  std::string of_site;
  int make = 0;
  CLI::App app("Check the site and split its configuration; called by the make graph.", "plumbline configure");
  app.add_option("--block-stages", of_blocks, "stages that run once per block")->required();
  app.add_option("--site-stages", of_site, "stages that run once")->required();
  app.add_option("--make-pid", make, "keep other makes away until this process ends");
  if (!pipeline::ParseArguments(arguments, &app)) return 0;
  if (make > 0) pipeline::LockSiteUntilEndOf(".", make);
  pipeline::ConfigureSite(".",
                          pipeline::AskStages(pipeline::Words(of_blocks), pipeline::Words(of_site), "work/.programs"));
  return 0;
}

int RunStage(const std::string& stage, const Arguments& arguments,
             const std::map<std::string, std::function<int(const Arguments&)>>& commands) {
  const fs::path bin = pipeline::OwnFolder();
  std::vector<std::string> known = pipeline::InstalledStages(bin);
  if (std::find(known.begin(), known.end(), stage) == known.end()) {
    for (const auto& [name, command] : commands) known.push_back(name);
    throw UsageError(stage + ": no such command" + pipeline::Suggestion(stage, known));
  }
  Arguments argv = {(bin / ("plumbline-" + stage)).string()};
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  pipeline::Become(argv);
}

int Dispatch(const Arguments& arguments) {
  static const std::map<std::string, std::function<int(const Arguments&)>> kCommands = {
      {"run", Run}, {"status", Status}, {"deliver", Deliver}, {"configure", Configure}};
  if (arguments.empty() || arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "help") {
    std::vector<std::string> stages = pipeline::InstalledStages(pipeline::OwnFolder());
    std::erase(stages, "new");
    std::cout << kHelp << "\nStages: " << pipeline::Joined(stages) << "\n";
    return arguments.empty() ? 2 : 0;
  }
  if (arguments[0] == "--version") {
    std::cout << "plumbline " << pipeline::Version() << "\n";
    return 0;
  }
  if (arguments[0] == "--graph") {
    std::cout << pipeline::GraphFile().string() << "\n";
    return 0;
  }
  const Arguments rest(arguments.begin() + 1, arguments.end());
  const auto command = kCommands.find(arguments[0]);
  return command != kCommands.end() ? command->second(rest) : RunStage(arguments[0], rest, kCommands);
}

}  // namespace

int main(int argc, char** argv) {
  return pipeline::RunProgram([&] { return Dispatch({argv + 1, argv + argc}); });
}
