// SPDX-License-Identifier: Apache-2.0
//
// The review page's server: loopback only, for people who were given a link (guard.h). It reads what the page shows and
// writes nothing but answers and the ledger of edits, each checked as the stages check them.
//
//   GET    /?token=T                     opens a session, once
//   GET    / /ar/ /review/... /vendor/...  the pages and what they are made of
//   GET    /api/site|requests|control|seams|answers|edits
//   GET    /tiles/LAYER/ZOOM/COLUMN/ROW.png
//   PUT    /api/answers/BLOCK/STAMP      with If-Match, or If-None-Match: * for the first answer to a scan
//   DELETE /api/answers/BLOCK/STAMP      with If-Match
//   POST   /api/edits                    with If-Match: the head of the ledger
//
// Refusals are JSON, {"error": ...}: 400 breaks a rule, 403 not let in, 404 no such thing, 409 the page is of another
// build, 412 somebody else was faster, 413 too large, 428 the state that was seen is not told.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace review {

class Server {
 public:
  // Port 0: any that is free. DataError when the port is taken. `invite` is called with a new link when the last one
  // was used.
  Server(std::filesystem::path site, const std::filesystem::path& web, int port,
         std::function<void(const std::string& link)> invite);
  ~Server();

  void Serve();  // returns after Stop()
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace review
