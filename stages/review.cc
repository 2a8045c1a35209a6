// SPDX-License-Identifier: Apache-2.0
//
// plumbline-review: a local page on which people answer review requests and edit the map. It writes answers and the
// ledger of edits, nothing else.
#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <iostream>
#include <thread>

#include "pipeline/stage.h"
#include "pipeline/subprocess.h"
#include "stages/review/import_review.h"
#include "stages/review/server.h"
#include "stages/review/site_lock.h"
#include "stages/review/static_page.h"

namespace {

namespace fs = std::filesystem;

fs::path WebFolder() { return pipeline::OwnFolder().parent_path() / "share" / "plumbline" / "web"; }

void CheckIsSite(const fs::path& site) {
  if (fs::exists(site / "Makefile") && fs::exists(site / "site.toml")) return;
  throw formats::UsageError(site.string() + ": no Makefile and site.toml in it, so it is not a site");
}

// Serves until Ctrl-C. Signals are taken by a thread that waits for them, so that nothing is cut short.
void Serve(const fs::path& site, int port, pipeline::StageRun& run) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  std::atomic<bool> first = true;
  review::Server server(site, WebFolder(), port, [&](const std::string& link) {
    if (first.exchange(false)) {
      std::cout << link << std::endl;
      run.Message("the link above works once, on this computer; Ctrl-C ends");
    } else {
      run.Message("link for another person or browser: " + link);
    }
  });
  std::thread waiting([&] {
    int signal = 0;
    sigwait(&signals, &signal);
    server.Stop();
  });
  server.Serve();
  waiting.join();
}

}  // namespace

int main(int argc, char** argv) {
  pipeline::Stage stage("review", "Answer review requests and edit the map on a local page.",
                        "plumbline review office   # then open the link that it prints");
  fs::path site;
  int port = 0;
  std::string static_folder;
  std::string import_file;
  stage.Positional("SITE", &site, "the site's folder");
  stage.Option("port", &port, "port on 127.0.0.1; 0: any that is free", {.min = 0, .max = 65535});
  stage.Text("static", &static_folder,
             "write the page with its data into this folder instead, for use without a server");
  stage.Text("import", &import_file, "take over the answers and edits that such a page has saved");
  return stage.Run(argc, argv, [&](pipeline::StageRun& run) {
    CheckIsSite(site);
    const fs::path folder = fs::canonical(site);
    if (!static_folder.empty() && !import_file.empty())
      throw formats::UsageError("--static and --import exclude each other");
    if (!static_folder.empty()) {
      const int tiles = review::WriteStaticPage(folder, WebFolder(), static_folder);
      run.Message("wrote " + (fs::path(static_folder) / "index.html").string() + " with " + std::to_string(tiles) +
                  " tiles; open it in a browser");
      return;
    }
    const review::SiteLock lock(folder);
    if (!import_file.empty()) {
      run.Message(review::ImportReview(folder, import_file));
    } else {
      Serve(folder, port, run);
    }
  });
}
