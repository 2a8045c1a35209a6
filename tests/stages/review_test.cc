// SPDX-License-Identifier: Apache-2.0
//
// The review server through real sockets: who is let in, what is refused, and that two people lose nothing.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "formats/artefacts.h"
#include "formats/atomic_file.h"
#include "tests/support/command.h"
#include "tests/support/job_site.h"
#include "tests/support/paths.h"
// clang-format off: last, since <resolv.h> below it defines _res, a name of Eigen's
#include <httplib.h>
// clang-format on

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::JobSite;

// `plumbline review SITE` as a process of its own; its standard output gives the first link.
class ReviewProcess {
 public:
  explicit ReviewProcess(const fs::path& site) {
    std::array<int, 2> out{};
    EXPECT_EQ(pipe(out.data()), 0);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(out[1], STDOUT_FILENO);
      dup2(open((site / "review.log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDERR_FILENO);
      close(out[0]);
      const std::string program = test_support::BinFolder() / "plumbline-review";
      execl(program.c_str(), program.c_str(), site.c_str(), nullptr);
      _exit(127);
    }
    close(out[1]);
    std::array<char, 256> text{};
    const ssize_t size = read(out[0], text.data(), text.size());
    close(out[0]);
    std::smatch parts;
    const std::string link(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    EXPECT_TRUE(std::regex_search(link, parts, std::regex(R"(:(\d+)/\?token=([0-9a-f]+))"))) << link;
    port_ = std::stoi(parts[1]);
    token_ = parts[2];
  }
  ~ReviewProcess() {
    kill(pid_, SIGTERM);
    int status = 0;
    waitpid(pid_, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
  ReviewProcess(const ReviewProcess&) = delete;
  ReviewProcess& operator=(const ReviewProcess&) = delete;

  int port() const { return port_; }
  const std::string& token() const { return token_; }

 private:
  pid_t pid_ = 0;
  int port_ = 0;
  std::string token_;
};

class ReviewTest : public testing::Test {
 protected:
  ReviewTest() : client_("127.0.0.1", server_.port()) {
    client_.set_keep_alive(true);
    const auto entered = client_.Get("/?token=" + server_.token());
    const std::string cookie = entered->get_header_value("Set-Cookie");
    session_ = {{"Cookie", cookie.substr(0, cookie.find(';'))}};
    EXPECT_NE(cookie.find("HttpOnly; SameSite=Strict"), std::string::npos);
    std::smatch build;
    const std::string page = client_.Get("/", session_)->body;
    EXPECT_TRUE(std::regex_search(page, build, std::regex("plumbline-build\" content=\"([0-9a-f]+)\"")));
    writing_ = session_;
    writing_.emplace("X-Plumbline-Page", build[1]);
  }

  static httplib::Headers With(httplib::Headers headers, const std::string& name, const std::string& value) {
    headers.erase(name);
    headers.emplace(name, value);
    return headers;
  }

  // A correction of scan 40 of block A against scan 10.
  json Answer() const {
    const auto stamps = formats::ReadScanStamps(site_ / "work/A/track.sqlite");
    return {{"schema", 1},
            {"stamp_ns", std::to_string(stamps.at(40).clock_ns)},
            {"decision", "correct"},
            {"ref", {{"stamp_ns", std::to_string(stamps.at(10).clock_ns)}}},
            {"pose", {1.25, -0.5, 0.125}},
            {"operator", "AB"}};
  }
  static json Wall(const std::string& uid) {
    return {{"operations",
             {{{"op", "add"},
               {"uid", uid},
               {"kind", "line_occupied"},
               {"width_m", 0.1},
               {"geometry", {{"type", "LineString"}, {"coordinates", {{500102.0, 5600202.0}, {500104.0, 5600202.5}}}}},
               {"who", "AB"},
               {"when", "2026-11-28T10:15:00Z"}}}}};
  }
  std::string PathOf(const json& answer) const { return "/api/answers/A/" + answer["stamp_ns"].get<std::string>(); }
  httplib::Result Put(const json& answer, const httplib::Headers& headers) {
    return client_.Put(PathOf(answer), headers, answer.dump(), "application/json");
  }
  httplib::Result Append(const json& body, const std::string& head) {
    return client_.Post("/api/edits", With(writing_, "If-Match", "\"" + head + "\""), body.dump(), "application/json");
  }
  std::string Head() { return json::parse(client_.Get("/api/edits", session_)->body)["head"]; }
  std::size_t NumFiles() const {
    std::size_t count = 0;
    for (const char* folder : {"blocks/A/answers", "edits"}) {
      if (!fs::exists(site_ / folder)) continue;
      for ([[maybe_unused]] const auto& file : fs::directory_iterator(site_ / folder)) ++count;
    }
    return count;
  }

  JobSite site_ = JobSite::Processed();
  ReviewProcess server_{site_.path()};
  httplib::Client client_;
  httplib::Headers session_;
  httplib::Headers writing_;
};

TEST_F(ReviewTest, LetsNobodyInWithoutTheLink) {
  EXPECT_EQ(client_.Get("/")->status, 403);
  EXPECT_EQ(client_.Get("/api/site")->status, 403);
  EXPECT_EQ(client_.Get("/review/main.js")->status, 403);
  EXPECT_EQ(client_.Get("/?token=" + server_.token())->status, 403) << "a link works once";
  EXPECT_EQ(client_.Get("/?token=")->status, 403);
  EXPECT_EQ(client_.Get("/", {{"Cookie", "plumbline-review-" + std::to_string(server_.port()) + "=0123"}})->status,
            403);
  EXPECT_EQ(client_.Get("/", session_)->status, 200);
}

TEST_F(ReviewTest, RefusesForeignHostsAndOrigins) {
  const std::string port = std::to_string(server_.port());
  const auto status = [&](const std::string& name, const std::string& value) {
    return client_.Get("/api/site", With(session_, name, value))->status;
  };
  EXPECT_EQ(status("Host", "evil.example"), 403);
  EXPECT_EQ(status("Host", "evil.example:" + port), 403);
  EXPECT_EQ(status("Host", "127.0.0.1:1"), 403);
  EXPECT_EQ(status("Origin", "http://evil.example"), 403);
  EXPECT_EQ(status("Origin", "null"), 403);
  EXPECT_EQ(status("Origin", "http://127.0.0.1:1"), 403);
  EXPECT_EQ(status("Origin", "http://127.0.0.1:" + port), 200);
  const auto written = Put(Answer(), With(With(writing_, "If-None-Match", "*"), "Origin", "http://evil.example"));
  EXPECT_EQ(written->status, 403);
  EXPECT_EQ(NumFiles(), 0U);
}

TEST_F(ReviewTest, ListensOnLoopbackOnly) {
  std::ifstream sockets("/proc/net/tcp");
  char port[16];
  std::snprintf(port, sizeof port, ":%04X", server_.port());
  int listening = 0;
  for (std::string line; std::getline(sockets, line);) {
    if (line.find(port) == std::string::npos || line.find(" 0A ") == std::string::npos) continue;
    ++listening;
    EXPECT_NE(line.find("0100007F" + std::string(port)), std::string::npos) << line;
  }
  EXPECT_EQ(listening, 1);
}

TEST_F(ReviewTest, HandsOutNoOtherFiles) {
  for (const char* path : {"/review/../../../site.toml", "/review/..%2f..%2fsite.toml",
                           "/vendor/%2e%2e/%2e%2e/options/track", "/site.toml", "/api/../site.toml",
                           "/tiles/../../x/0/0/0.png", "/tiles/raw-..%2fA/0/0/0.png", "/review/", "/etc/passwd"}) {
    EXPECT_EQ(client_.Get(path, session_)->status, 404) << path;
  }
  const json answer = Answer();
  for (const char* block : {"..", "%2e%2e", "A%2f..%2fA", "Z"}) {
    const auto put = client_.Put("/api/answers/" + std::string(block) + "/" + answer["stamp_ns"].get<std::string>(),
                                 With(writing_, "If-None-Match", "*"), answer.dump(), "application/json");
    EXPECT_GE(put->status, 400) << block;
  }
  EXPECT_EQ(NumFiles(), 0U);
}

TEST_F(ReviewTest, RefusesAHugeBody) {
  const std::string huge(100U << 20, ' ');
  const auto put = client_.Put(PathOf(Answer()), With(writing_, "If-None-Match", "*"), huge, "application/json");
  EXPECT_TRUE(!put || put->status == 413);
  EXPECT_EQ(client_.Get("/api/site", session_)->status, 200) << "goes on";
}

TEST_F(ReviewTest, RefusesThePageOfAnotherBuild) {
  const auto put = Put(Answer(), With(With(writing_, "If-None-Match", "*"), "X-Plumbline-Page", "0123456789abcdef"));
  EXPECT_EQ(put->status, 409);
  EXPECT_EQ(Put(Answer(), With(session_, "If-None-Match", "*"))->status, 409);
  EXPECT_EQ(NumFiles(), 0U);
}

TEST_F(ReviewTest, AnswersOfTwoPeople) {
  const json first = Answer();
  EXPECT_EQ(Put(first, writing_)->status, 428);
  const auto written = Put(first, With(writing_, "If-None-Match", "*"));
  ASSERT_EQ(written->status, 200) << written->body;
  const std::string tag = written->get_header_value("ETag");

  json second = first;
  second["pose"] = {9.0, 9.0, 0.0};
  EXPECT_EQ(Put(second, With(writing_, "If-None-Match", "*"))->status, 412);
  EXPECT_EQ(Put(second, With(writing_, "If-Match", "\"0123456789abcdef\""))->status, 412);
  const fs::path file = site_ / ("blocks/A/answers/" + first["stamp_ns"].get<std::string>() + ".json");
  const json on_disk = json::parse(formats::ReadWholeFile(file));
  EXPECT_EQ(on_disk["pose"], first["pose"]);
  EXPECT_TRUE(on_disk["stamp_ns"].is_number_integer());

  EXPECT_EQ(Put(second, With(writing_, "If-Match", tag))->status, 200);
  EXPECT_EQ(client_.Delete(PathOf(first), With(writing_, "If-Match", tag))->status, 412);
  const json all = json::parse(client_.Get("/api/answers", session_)->body);
  const std::string now = all["A"][first["stamp_ns"].get<std::string>()]["tag"];
  EXPECT_EQ(client_.Delete(PathOf(first), With(writing_, "If-Match", "\"" + now + "\""))->status, 200);
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(ReviewTest, AnswersThatTheStagesWouldRefuse) {
  const auto refused = [&](const char* key, const json& value) {
    json answer = Answer();
    answer[key] = value;
    const auto put = Put(answer, With(writing_, "If-None-Match", "*"));
    EXPECT_EQ(put->status, 400) << key;
    return put->body;
  };
  EXPECT_NE(refused("decision", "perhaps").find("perhaps"), std::string::npos);
  EXPECT_NE(refused("pose", {1000.0, 0.0, 0.0}).find("outside the map"), std::string::npos);
  EXPECT_NE(refused("sigma", {0.0, 0.1, 0.1}).find("positive"), std::string::npos);
  refused("ref", {{"stamp_ns", "12"}});
  refused("surprise", 1);
  const auto garbage = client_.Put(PathOf(Answer()), With(writing_, "If-None-Match", "*"), "{", "application/json");
  EXPECT_EQ(garbage->status, 400);
  EXPECT_EQ(NumFiles(), 0U);
}

TEST_F(ReviewTest, EditsOfTwoPeople) {
  const std::string head = Head();
  const auto first = Append(Wall("aaaaaaaaaaaa"), head);
  ASSERT_EQ(first->status, 200) << first->body;
  EXPECT_EQ(Append(Wall("bbbbbbbbbbbb"), head)->status, 412);
  EXPECT_EQ(Append(Wall("bbbbbbbbbbbb"), Head())->status, 200);
  EXPECT_EQ(Append(Wall("bbbbbbbbbbbb"), Head())->status, 400) << "a uid twice";
  json bow = Wall("cccccccccccc");
  bow["operations"][0].erase("width_m");
  bow["operations"][0]["kind"] = "area_free";
  bow["operations"][0]["geometry"] = {{"type", "Polygon"}, {"coordinates", {{{0, 0}, {1, 1}, {1, 0}, {0, 1}, {0, 0}}}}};
  EXPECT_NE(Append(bow, Head())->body.find("crosses"), std::string::npos);
  json off = Wall("cccccccccccc");
  off["operations"][0]["geometry"]["coordinates"][1][0] = 500904.0;
  EXPECT_NE(Append(off, Head())->body.find("edit 1: line_occupied cccccccccccc: vertex 2 at E 500904.000"),
            std::string::npos);
  const json edits = json::parse(client_.Get("/api/edits", session_)->body)["edits"];
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[1]["uid"], "bbbbbbbbbbbb");
}

// Of the whole site nothing changes but answers, the ledger, and the log that this test has its messages written to.
TEST_F(ReviewTest, WritesNothingButAnswersAndEdits) {
  const auto written = [&] {
    std::map<std::string, fs::file_time_type> files;
    for (const auto& entry : fs::recursive_directory_iterator(site_.path())) {
      if (entry.is_regular_file()) files[fs::relative(entry.path(), site_.path())] = entry.last_write_time();
    }
    return files;
  };
  const auto before = written();
  for (const char* document : {"site", "requests", "control", "seams", "answers", "edits"})
    EXPECT_EQ(client_.Get(std::string("/api/") + document, session_)->status, 200);
  EXPECT_EQ(client_.Get("/tiles/map/0/0/0.png", session_)->status, 200);
  ASSERT_EQ(Put(Answer(), With(writing_, "If-None-Match", "*"))->status, 200);
  ASSERT_EQ(Append(Wall("eeeeeeeeeeee"), Head())->status, 200);
  int changed = 0;
  for (const auto& [file, time] : written()) {
    if (before.contains(file) && before.at(file) == time) continue;
    ++changed;
    const bool may = file.starts_with("blocks/A/answers/") || file.starts_with("edits/") || file == "review.log";
    EXPECT_TRUE(may) << file;
  }
  EXPECT_GE(changed, 2);
}

TEST_F(ReviewTest, OneServerForASite) {
  const auto second = test_support::RunCommand({"plumbline-review", site_.path()});
  EXPECT_EQ(second.status, 1);
  EXPECT_NE(second.err.find("another plumbline review"), std::string::npos) << second.err;
}

// What is saved by a page without a server arrives once, and never over somebody else's answer.
TEST_F(ReviewTest, StaticPageAndImport) {
  const JobSite other = JobSite::Processed();
  const auto page = test_support::RunCommand({"plumbline-review", other.path(), "--static", other / "page"});
  ASSERT_EQ(page.status, 0) << page.err;
  for (const char* file : {"index.html", "data.js", "vendor/ol/ol.js", "tiles/map/0/0/0.png"})
    EXPECT_TRUE(fs::exists(other / "page" / file)) << file;
  EXPECT_EQ(formats::ReadWholeFile(other / "page/index.html").find("@IMPORTS@"), std::string::npos);

  json saved = {
      {"format", "plumbline-review"}, {"format_version", 1}, {"operations", Wall("dddddddddddd")["operations"]}};
  saved["answers"] = {{{"block", "A"}, {"seen", ""}, {"answer", Answer()}}};
  formats::WriteFileAtomically(other / "saved.json", saved.dump());
  const auto import = [&] {
    return test_support::RunCommand({"plumbline-review", other.path(), "--import", other / "saved.json"});
  };
  EXPECT_EQ(import().status, 0);
  EXPECT_TRUE(fs::exists(other / ("blocks/A/answers/" + Answer()["stamp_ns"].get<std::string>() + ".json")));
  EXPECT_EQ(import().status, 1) << "the edit is there already";
  saved["answers"][0]["answer"]["pose"] = {0.0, 0.0, 0.0};
  formats::WriteFileAtomically(other / "saved.json", saved.dump());
  const auto conflict = import();
  EXPECT_EQ(conflict.status, 1);
  EXPECT_NE(conflict.err.find("somebody else has answered"), std::string::npos) << conflict.err;
}

}  // namespace
