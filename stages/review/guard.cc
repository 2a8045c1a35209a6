// SPDX-License-Identifier: Apache-2.0
#include "stages/review/guard.h"

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace review {
namespace {

std::string ValueOfCookie(const std::string& header, const std::string& name) {
  std::istringstream cookies(header);
  for (std::string cookie; std::getline(cookies >> std::ws, cookie, ';');) {
    if (cookie.starts_with(name + "=")) return cookie.substr(name.size() + 1);
  }
  return "";
}

}  // namespace

std::string Guard::Secret() {
  std::array<unsigned char, 24> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error(std::string("no random numbers: ") + std::strerror(errno));
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

Guard::Guard(int port) : port_(std::to_string(port)) {}

std::string Guard::NewInvitation() {
  const std::string token = Secret();
  const std::lock_guard lock(mutex_);
  tokens_.insert(token);
  return "http://127.0.0.1:" + port_ + "/?token=" + token;
}

std::string Guard::Redeem(const std::string& token) {
  const std::lock_guard lock(mutex_);
  if (tokens_.erase(token) == 0) return "";
  return *sessions_.insert(Secret()).first;
}

// Cookies do not know ports: another site's server on this machine has another name.
std::string Guard::CookieName() const { return "plumbline-review-" + port_; }

std::string Guard::CookieFor(const std::string& session) const {
  return CookieName() + "=" + session + "; Path=/; HttpOnly; SameSite=Strict";
}

std::string Guard::RefusalOfSender(const std::string& host, const std::string& origin) const {
  if (host != "127.0.0.1:" + port_ && host != "localhost:" + port_) return "foreign Host";
  if (!origin.empty() && origin != "http://" + host) return "foreign Origin";
  return "";
}

std::string Guard::RefusalOf(const std::string& host, const std::string& origin, const std::string& cookie) const {
  if (std::string refusal = RefusalOfSender(host, origin); !refusal.empty()) return refusal;
  const std::string session = ValueOfCookie(cookie, CookieName());
  const std::lock_guard lock(mutex_);
  return sessions_.contains(session) ? "" : "no session: open the link that plumbline review printed last";
}

}  // namespace review
