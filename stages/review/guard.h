// SPDX-License-Identifier: Apache-2.0
//
// Who may talk to the review server. It listens on loopback, but any page in the same browser can send requests there,
// and a name that an attacker owns can be made to point there (DNS rebinding). So: the Host must be ours, an Origin
// must be ours, and a cookie must hold a session that began with a link which was printed on the terminal and works
// once.
#pragma once

#include <mutex>
#include <set>
#include <string>

namespace review {

class Guard {
 public:
  explicit Guard(int port);

  static std::string Secret();  // 192 random bits as text

  // A link that lets one person in, once.
  std::string NewInvitation();

  // The session that a link's token opens; empty when it was used already or never given.
  std::string Redeem(const std::string& token);
  std::string CookieFor(const std::string& session) const;  // value of Set-Cookie

  // Why a request is turned away, from its headers (empty: not sent); empty when it is let in.
  std::string RefusalOf(const std::string& host, const std::string& origin, const std::string& cookie) const;
  std::string RefusalOfSender(const std::string& host,
                              const std::string& origin) const;  // without a look at the cookie

 private:
  std::string CookieName() const;

  std::string port_;
  mutable std::mutex mutex_;
  std::set<std::string> tokens_;
  std::set<std::string> sessions_;
};

}  // namespace review
