// Decides who sees the web pages, and serves the forms to log in and out.
//
// Without a gate everybody is answered: only this machine can connect. Programs of the user who runs the
// coordinator may then do everything, as through its Unix socket, and those of other users may look. With a
// gate, the pages are for members who may look at the farm: they show their certificate in the handshake or,
// with a browser, the cookie of a session that a token has opened. Others see a form that asks for a token,
// and nothing about the farm.
//
// A request that changes something must carry the proof that /api/v1/me shows, in a header: pages of other
// sites can neither read it nor send such a header. If it names an origin, as browsers do, that must be this
// server.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/listener/peer_budget.h"
#include "coordinator/web/http_request.h"
#include "coordinator/web/http_response.h"
#include "coordinator/web/session_table.h"
#include "coordinator/web/web_content.h"
#include "coordinator/web/web_gate.h"
#include "proto/identity/secrets.h"
#include "proto/shell/rare_log.h"

namespace tessera {

// A connection, as far as answers depend on it.
struct WebPeer {
  std::string text;  // its address, for logs
  PeerNetwork network;
  std::optional<Certificate> certificate;  // that it has shown and the handshake has accepted
  std::optional<Certificate> own;          // that of the server, if the connection is encrypted
  bool is_own_user = false;  // whether a program of the user who runs the coordinator has made the connection
};

// Used by one thread.
class WebSite {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // Answers requests for `names`, see IsOwnHost, and over TLS for the names of the certificate.
  WebSite(std::vector<std::string> names, std::shared_ptr<WebContent> content, std::optional<WebGate> gate);
  // For a HEAD too, whose answer goes out without its body. If the body of the request is too long to be
  // kept, the answer has a sink that takes it, or refuses it.
  HttpResponse Answer(const HttpRequest& request, const WebPeer& peer, TimePoint now);

 private:
  static constexpr std::chrono::seconds kLogInterval{10};
  // Who makes a request.
  struct Visit {
    std::optional<Visitor> visitor;
    std::string session;  // the secret of the session, if there is one
    std::string problem;  // why the certificate that was shown is not enough
  };

  bool IsForUs(const HttpRequest& request, const WebPeer& peer) const;
  Visit Identify(const HttpRequest& request, const WebPeer& peer, TimePoint now);
  HttpResponse AnswerStranger(const HttpRequest& request, const Visit& visit) const;
  HttpResponse Show(const HttpRequest& request, const WebVisit& visit, const WebPeer& peer);
  HttpResponse WithRechecks(HttpResponse response, const std::string& session, const WebPeer& peer,
                            MemberId member);
  HttpResponse LogIn(const HttpRequest& request, const WebPeer& peer, TimePoint now);
  HttpResponse LogOut(const HttpRequest& request, const WebPeer& peer, const Visit& visit);
  HttpResponse LoginForm(const HttpRequest& request, int status, const std::string& problem) const;
  Result<Visitor> UseToken(const std::string& text, const WebPeer& peer) const;
  std::string ProofFor(const char* purpose, const std::string& secret) const;
  bool IsStillAdmitted(const std::string& session, const std::optional<Certificate>& certificate,
                       MemberId member) const;

  const std::vector<std::string> names_;
  const std::shared_ptr<WebContent> content_;
  const std::optional<WebGate> gate_;
  const std::string proof_key_ = RandomSecret();
  SessionTable sessions_;
  PeerBudget logins_;
  RareLog failed_logins_{kLogInterval};
};

}  // namespace tessera
