// SPDX-License-Identifier: Apache-2.0
#include "stages/review/server.h"

#include <sys/socket.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "formats/errors.h"
#include "formats/json_text.h"
#include "stages/review/answer_store.h"
#include "stages/review/edit_store.h"
#include "stages/review/guard.h"
#include "stages/review/site_documents.h"
#include "stages/review/tile_layers.h"
#include "stages/review/web_files.h"
// clang-format off: last, since <resolv.h> below it defines _res, a name of Eigen's
#include <httplib.h>
// clang-format on

namespace review {
namespace {

namespace fs = std::filesystem;
using httplib::Request;
using httplib::Response;
using nlohmann::json;

constexpr std::size_t kMaxBody = 4 << 20;
constexpr std::size_t kThreads = 32;  // browsers keep six connections open each
constexpr const char* kJson = "application/json";

void Refuse(Response& response, int status, const std::string& message) {
  response.status = status;
  response.set_content(formats::JsonText(json{{"error", message}}), kJson);
}

std::string MessageOf(int status) {
  if (status == 413) return "the body is larger than " + std::to_string(kMaxBody >> 20) + " MB";
  return status == 404 ? "no such thing" : "status " + std::to_string(status);
}

// As it is: httplib would spend seconds on Brotli for what goes no farther than this computer.
void SendUncompressed(Response& response, std::shared_ptr<const std::string> bytes, const std::string& type) {
  const std::size_t size = bytes->size();
  response.set_content_provider(size, type,
                                [bytes = std::move(bytes)](std::size_t from, std::size_t length, auto& sink) {
                                  return sink.write(bytes->data() + from, length);
                                });
}

void Send(Response& response, const json& document) {
  response.set_header("Cache-Control", "no-store");
  SendUncompressed(response, std::make_shared<std::string>(formats::JsonText(document)), kJson);
}

std::string Quoted(const std::string& tag) { return "\"" + tag + "\""; }

// The state that a writer has seen: the tag in If-Match, "" for If-None-Match: *, nothing when he does not tell.
std::optional<std::string> SeenBy(const Request& request) {
  const std::string match = request.get_header_value("If-Match");
  if (match.size() >= 2 && match.front() == '"' && match.back() == '"') return match.substr(1, match.size() - 2);
  if (request.get_header_value("If-None-Match") == "*") return "";
  return std::nullopt;
}

void SendWritten(Response& response, const Written& written) {
  if (!written.tag.empty()) response.set_header("ETag", Quoted(written.tag));
  if (written.outcome == Written::Outcome::kStale) return Refuse(response, 412, written.message);
  if (written.outcome == Written::Outcome::kRefused) return Refuse(response, 400, written.message);
  Send(response, {{"tag", written.tag}});
}

// Nothing from elsewhere, no page around ours; OpenLayers and three.js need pictures made in the page.
std::string ContentPolicy(const std::string& nonce) {
  return "default-src 'self'; script-src 'self' 'nonce-" + nonce +
         "'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; frame-ancestors 'none'; base-uri 'none'; "
         "form-action 'none'";
}

}  // namespace

struct Server::Impl {
  fs::path site;
  WebFiles web;
  TileLayers tiles;
  AnswerStore answers;
  EditStore edits;
  std::function<void(const std::string&)> invite;
  httplib::Server http;
  std::optional<Guard> guard;

  Impl(const fs::path& folder, const fs::path& web_folder)
      : site(folder), web(web_folder), tiles(folder), answers(folder), edits(folder) {}

  void Listen(int port);
  void SetRoutes();
  void Enter(const Request& request, Response& response);
  void SendPage(const std::string& path, Response& response);
  void SendWebFile(const Request& request, Response& response);
  void SendDocument(const std::string& name, Response& response);
  void SendTile(const Request& request, Response& response);

  httplib::Server::Handler Guarded(httplib::Server::Handler handler);
  httplib::Server::Handler Writing(std::function<Written(const Request&, const std::string& seen)> write);
};

void Server::Impl::Listen(int port) {
  http.set_payload_max_length(kMaxBody);
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_socket_options([](socket_t socket) {  // not SO_REUSEPORT: nobody may listen beside us
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  http.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                            {"Referrer-Policy", "no-referrer"},
                            {"Cross-Origin-Resource-Policy", "same-origin"}});
  const bool bound = port == 0 ? (port = http.bind_to_any_port("127.0.0.1")) > 0 : http.bind_to_port("127.0.0.1", port);
  if (!bound) throw formats::DataError("port " + std::to_string(port) + ": cannot be listened on; is it taken?");
  guard.emplace(port);
}

void Server::Impl::SetRoutes() {
  http.set_exception_handler([](const Request&, Response& response, std::exception_ptr error) {
    try {
      std::rethrow_exception(std::move(error));
    } catch (const std::exception& failure) {
      Refuse(response, 500, failure.what());
    }
  });
  http.set_error_handler([](const Request&, Response& response) {
    if (response.body.empty()) Refuse(response, response.status, MessageOf(response.status));
  });
  http.Get("/", [this](const Request& request, Response& response) { Enter(request, response); });
  http.Get("/ar/", Guarded([this](const Request&, Response& response) { SendPage("ar/index.html", response); }));
  http.Get(R"(/((?:review|ar|shared|vendor)/[A-Za-z0-9_./-]+))",
           Guarded([this](const Request& request, Response& response) { SendWebFile(request, response); }));
  http.Get(R"(/api/([a-z]+))",
           Guarded([this](const Request& request, Response& response) { SendDocument(request.matches[1], response); }));
  http.Get(R"(/tiles/([A-Za-z0-9_-]+)/(\d{1,2})/(\d{1,6})/(\d{1,6})\.png)",
           Guarded([this](const Request& request, Response& response) { SendTile(request, response); }));
  const char* const answer = R"(/api/answers/([A-Za-z0-9_-]+)/(-?\d{1,19}))";
  http.Put(answer, Writing([this](const Request& request, const std::string& seen) {
             return answers.Put(request.matches[1], request.matches[2], formats::ParsedJson(request.body), seen);
           }));
  http.Delete(answer, Writing([this](const Request& request, const std::string& seen) {
                return answers.Remove(request.matches[1], request.matches[2], seen);
              }));
  http.Post("/api/edits", Writing([this](const Request& request, const std::string& seen) {
              return edits.Append(formats::ParsedJson(request.body), seen);
            }));
}

httplib::Server::Handler Server::Impl::Guarded(httplib::Server::Handler handler) {
  return [this, handler = std::move(handler)](const Request& request, Response& response) {
    const std::string refusal = guard->RefusalOf(request.get_header_value("Host"), request.get_header_value("Origin"),
                                                 request.get_header_value("Cookie"));
    if (!refusal.empty()) return Refuse(response, 403, refusal);
    handler(request, response);
  };
}

httplib::Server::Handler Server::Impl::Writing(std::function<Written(const Request&, const std::string& seen)> write) {
  return Guarded([this, write = std::move(write)](const Request& request, Response& response) {
    if (request.get_header_value("X-Plumbline-Page") != web.build())
      return Refuse(response, 409, "this page is of another build of Plumbline: load it again");
    const std::optional<std::string> seen = SeenBy(request);
    if (!seen) return Refuse(response, 428, "If-Match or If-None-Match: * is required");
    try {
      SendWritten(response, write(request, *seen));
    } catch (const json::exception& error) {
      Refuse(response, 400, std::string("body: ") + error.what());
    }
  });
}

void Server::Impl::Enter(const Request& request, Response& response) {
  if (!request.has_param("token")) {
    return Guarded([this](const Request&, Response& page) { SendPage("review/index.html", page); })(request, response);
  }
  const std::string refusal =
      guard->RefusalOfSender(request.get_header_value("Host"), request.get_header_value("Origin"));
  const std::string session = refusal.empty() ? guard->Redeem(request.get_param_value("token")) : "";
  if (session.empty()) return Refuse(response, 403, refusal.empty() ? "this link was used already" : refusal);
  response.set_header("Set-Cookie", guard->CookieFor(session));
  response.set_redirect("/", 303);
  invite(guard->NewInvitation());
}

void Server::Impl::SendPage(const std::string& path, Response& response) {
  const std::string nonce = Guard::Secret();
  response.set_header("Cache-Control", "no-store");
  response.set_header("Content-Security-Policy", ContentPolicy(nonce));
  response.set_content(web.Page(path, nonce, false), WebFiles::TypeOf(path));
}

void Server::Impl::SendWebFile(const Request& request, Response& response) {
  const std::string path = request.matches[1];
  const std::string* bytes = web.Find(path);
  if (bytes == nullptr) return Refuse(response, 404, "no such file");
  response.set_header("Cache-Control", "no-cache");
  response.set_header("ETag", Quoted(web.build()));
  if (request.get_header_value("If-None-Match") == Quoted(web.build())) {
    response.status = 304;
    return;
  }
  // The files outlive every response.
  SendUncompressed(response, {std::shared_ptr<const std::string>(), bytes}, WebFiles::TypeOf(path));
}

void Server::Impl::SendDocument(const std::string& name, Response& response) {
  if (name == "site") return Send(response, SiteDocument(site, &tiles));
  if (name == "requests") return Send(response, RequestsDocument(site));
  if (name == "control") return Send(response, ControlDocument(site));
  if (name == "seams") return Send(response, SeamsDocument(site));
  if (name == "answers") return Send(response, answers.All());
  if (name == "edits") return Send(response, edits.All());
  Refuse(response, 404, "no such document");
}

void Server::Impl::SendTile(const Request& request, Response& response) {
  const auto number = [&](std::size_t group) { return std::stoi(request.matches[group]); };
  std::string version;
  const std::string png = tiles.Tile(request.matches[1], number(2), number(3), number(4), &version);
  if (png.empty()) return Refuse(response, 404, "no such tile");
  const bool lasting = request.get_param_value("v") == version;
  response.set_header("Cache-Control", lasting ? "private, max-age=31536000, immutable" : "no-store");
  response.set_content(png, "image/png");
}

Server::Server(fs::path site, const fs::path& web, int port, std::function<void(const std::string& link)> invite)
    : impl_(std::make_unique<Impl>(std::move(site), web)) {
  impl_->invite = std::move(invite);
  impl_->Listen(port);
  impl_->SetRoutes();
  impl_->invite(impl_->guard->NewInvitation());
}

Server::~Server() = default;

void Server::Serve() { impl_->http.listen_after_bind(); }

void Server::Stop() { impl_->http.stop(); }

}  // namespace review
