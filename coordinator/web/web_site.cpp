#include "coordinator/web/web_site.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/web/form.h"
#include "coordinator/web/login_page.h"
#include "proto/identity/join_token.h"
#include "proto/identity/subject.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// How soon the streams of somebody who was revoked or logged out end.
constexpr std::chrono::milliseconds kRecheckInterval{500};
// Nobody can guess a secret of 128 bits; this bounds the noise, and lets people mistype.
constexpr PeerBudget::Limits kLoginLimits{10, 0.2};

// The prefix makes browsers insist on Secure, on the path and on this very host.
constexpr const char* kSessionCookie = "__Host-tessera-session";
constexpr const char* kFormCookie = "__Host-tessera-form";
constexpr const char* kCookieAttributes = "Path=/; Secure; HttpOnly; SameSite=Strict";
constexpr int kFormLifetime_s = 3600;
constexpr size_t kSecretSize = 64;  // of RandomSecret

constexpr const char* kTokenPrefix = "tessera-";

bool IsGet(const HttpRequest& request) {
  return request.method == "GET" || request.method == "HEAD";
}

std::string WithoutBrackets(const std::string& host) {
  const bool has_brackets = host.starts_with('[') && host.ends_with(']');
  return has_brackets ? host.substr(1, host.size() - 2) : host;
}

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// Whether a name or a value of the query is a token. One that is malformed may hold half of one.
bool HasToken(const std::string& query) {
  const auto parameters = ParseForm(query);
  if (!parameters) return query.find(kTokenPrefix) != std::string::npos;
  return std::ranges::any_of(*parameters, [](const auto& each) {
    return JoinToken::Parse(Trimmed(each.first)).has_value() ||
           JoinToken::Parse(Trimmed(each.second)).has_value();
  });
}

// Whether the form was sent by a page of this server.
bool IsOwnForm(const HttpRequest& request) {
  return request.is_form && !request.authority.empty() && request.origin == "https://" + request.authority;
}

HttpResponse ForeignForm() {
  return HttpResponse::Plain(403, "The form was not sent by a page of this server.\n");
}

// A body of which nothing more is taken when its sender may not send it any more.
class CheckedSink final : public BodySink {
 public:
  CheckedSink(std::shared_ptr<BodySink> sink, std::function<bool()> is_admitted)
      : sink_(std::move(sink)), is_admitted_(std::move(is_admitted)) {}
  void Take(std::string piece, bool is_last, std::shared_ptr<LaterAnswer> answer) override {
    const auto now = std::chrono::steady_clock::now();
    if (now >= due_ && !is_admitted_())
      return answer->Give(HttpResponse::JsonError(401, "you are not logged in any more"));
    if (now >= due_) due_ = now + kRecheckInterval;
    sink_->Take(std::move(piece), is_last, std::move(answer));
  }

 private:
  const std::shared_ptr<BodySink> sink_;
  const std::function<bool()> is_admitted_;
  std::chrono::steady_clock::time_point due_{};
};

// A stream that ends when its reader may not read it any more.
class CheckedStream final : public BodyStream {
 public:
  CheckedStream(std::shared_ptr<BodyStream> stream, std::function<bool()> is_admitted)
      : stream_(std::move(stream)), is_admitted_(std::move(is_admitted)) {}
  Next Take(std::vector<Part>& parts) override {
    const auto now = std::chrono::steady_clock::now();
    if (now >= due_ && !is_admitted_()) return Next::kEnd;
    if (now >= due_) due_ = now + kRecheckInterval;
    return stream_->Take(parts);
  }

 private:
  const std::shared_ptr<BodyStream> stream_;
  const std::function<bool()> is_admitted_;
  std::chrono::steady_clock::time_point due_{};
};

}  // namespace

WebSite::WebSite(std::vector<std::string> names, std::shared_ptr<WebContent> content,
                 std::optional<WebGate> gate)
    : names_(std::move(names)), content_(std::move(content)), gate_(std::move(gate)), logins_(kLoginLimits) {}

HttpResponse WebSite::Answer(const HttpRequest& request, const WebPeer& peer, TimePoint now) {
  if (!IsForUs(request, peer))
    return HttpResponse::Plain(403, "The page is not served under this name; see --http-name.\n");
  if (!gate_) {
    const Visitor visitor = peer.is_own_user
                                ? Visitor{{}, kLocalOwner, std::string(RoleName(Role::kOperator))}
                                : Visitor{{}, "", ""};
    return Show(request, {visitor, peer.text, ProofFor("change", visitor.name), ""}, peer);
  }
  if (request.has_long_body() && (request.path == "/login" || request.path == "/logout"))
    return HttpResponse::Plain(413, "The request is too long.\n");
  if (HasToken(request.query)) {
    return HttpResponse::Plain(400,
                               "A token does not belong into an address, which browsers remember and show. "
                               "Have it revoked, and paste another into the form.\n");
  }
  const Visit visit = Identify(request, peer, now);
  if (request.path == "/login" && !peer.certificate) {
    if (IsGet(request) && visit.visitor) return HttpResponse::Redirect("/");
    return IsGet(request) ? LoginForm(request, 200, "") : LogIn(request, peer, now);
  }
  if (!visit.visitor) return AnswerStranger(request, visit);
  if (request.path == "/login") return HttpResponse::Redirect("/");
  if (request.path == "/logout" && !visit.session.empty()) return LogOut(request, peer, visit);
  WebVisit shown{*visit.visitor, peer.text, "", ""};
  shown.proof = ProofFor("change", visit.session + MemberIdText(visit.visitor->member));
  if (!visit.session.empty()) shown.logout_proof = ProofFor("logout", visit.session);
  HttpResponse response = Show(request, shown, peer);
  response.is_for_member = true;
  return WithRechecks(std::move(response), visit.session, peer, visit.visitor->member);
}

HttpResponse WebSite::Show(const HttpRequest& request, const WebVisit& visit, const WebPeer& peer) {
  if (!IsGet(request)) {
    const std::string own_origin = (peer.own ? "https://" : "http://") + request.authority;
    if (!request.origin.empty() && request.origin != own_origin)
      return HttpResponse::JsonError(403, "the request was sent by a page of another site");
    if (!AreEqualSecrets(request.proof, visit.proof)) {
      return HttpResponse::JsonError(
          403, "the header X-Tessera-Proof is missing or too old; /api/v1/me shows its value");
    }
  }
  return request.has_long_body() ? content_->Receive(request, visit) : content_->Answer(request, visit);
}

// An answer that is made later may be a stream too.
HttpResponse WebSite::WithRechecks(HttpResponse response, const std::string& session, const WebPeer& peer,
                                   MemberId member) {
  const auto is_admitted = [this, session, certificate = peer.certificate, member] {
    return IsStillAdmitted(session, certificate, member);
  };
  if (response.stream != nullptr)
    response.stream = std::make_shared<CheckedStream>(std::move(response.stream), is_admitted);
  if (response.sink != nullptr)
    response.sink = std::make_shared<CheckedSink>(std::move(response.sink), is_admitted);
  if (response.later != nullptr) {
    response.later->SetFinish([is_admitted](HttpResponse made) {
      if (made.stream != nullptr)
        made.stream = std::make_shared<CheckedStream>(std::move(made.stream), is_admitted);
      return made;
    });
  }
  return response;
}

bool WebSite::IsStillAdmitted(const std::string& session, const std::optional<Certificate>& certificate,
                              MemberId member) const {
  if (certificate) return gate_->identify(*certificate).has_value();
  return sessions_.IsOpen(session, std::chrono::steady_clock::now()) && gate_->recheck(member).has_value();
}

bool WebSite::IsForUs(const HttpRequest& request, const WebPeer& peer) const {
  if (!peer.own) return IsOwnHost(request.host, names_);
  return peer.own->IsForHost(WithoutBrackets(request.host)) || IsNameOf(request.host, names_);
}

WebSite::Visit WebSite::Identify(const HttpRequest& request, const WebPeer& peer, TimePoint now) {
  Visit visit;
  if (peer.certificate) {
    auto visitor = gate_->identify(*peer.certificate);
    if (visitor) {
      visit.visitor = std::move(*visitor);
    } else {
      visit.problem = visitor.error().message;
    }
    return visit;
  }
  const std::string secret = CookieValue(request.cookies, kSessionCookie);
  const auto member = sessions_.Use(secret, now);
  if (!member) return visit;
  auto visitor = gate_->recheck(*member);
  if (visitor) {
    visit.visitor = std::move(*visitor);
    visit.session = secret;
  } else {
    sessions_.End(secret);
  }
  return visit;
}

HttpResponse WebSite::AnswerStranger(const HttpRequest& request, const Visit& visit) const {
  if (!visit.problem.empty()) return HttpResponse::Plain(403, visit.problem + "\n");
  if (request.path == "/" && IsGet(request)) return HttpResponse::Redirect("/login");
  return HttpResponse::Plain(401, "This needs a certificate of the farm, or a login at /login.\n");
}

HttpResponse WebSite::LoginForm(const HttpRequest& request, int status, const std::string& problem) const {
  std::string secret = CookieValue(request.cookies, kFormCookie);
  if (secret.size() != kSecretSize) secret = RandomSecret();
  HttpResponse response =
      HttpResponse::Html(status, LoginPage(ProofFor("login", secret), problem), kLoginStyle);
  response.cookie =
      fmt::format("{}={}; {}; Max-Age={}", kFormCookie, secret, kCookieAttributes, kFormLifetime_s);
  return response;
}

HttpResponse WebSite::LogIn(const HttpRequest& request, const WebPeer& peer, TimePoint now) {
  if (request.method != "POST") return HttpResponse::Plain(405, "Only GET and POST are supported.\n");
  if (!IsOwnForm(request)) return ForeignForm();
  auto form = ParseForm(request.body);
  if (!form) return HttpResponse::Plain(400, "The form is malformed.\n");
  const std::string secret = CookieValue(request.cookies, kFormCookie);
  if (secret.empty() || !AreEqualSecrets((*form)["proof"], ProofFor("login", secret)))
    return LoginForm(request, 403, "The form is too old. Try again.");
  if (!logins_.Take(peer.network, now))
    return LoginForm(request, 429, "Too many attempts from your address. Try again in a minute.");
  const auto visitor = UseToken(Trimmed((*form)["token"]), peer);
  if (!visitor) {
    failed_logins_.Warn("login_failed", fmt::format("peer={} reason={}", LogText(peer.text),
                                                    LogText(visitor.error().message)));
    return LoginForm(request, 403, "Login failed: " + visitor.error().message + ".");
  }
  logins_.GiveBack(peer.network);
  HttpResponse response = HttpResponse::Redirect("/");
  response.cookie =
      fmt::format("{}={}; {}", kSessionCookie, sessions_.Open(visitor->member, now), kCookieAttributes);
  return response;
}

// The secret itself is not logged, and not kept.
Result<Visitor> WebSite::UseToken(const std::string& text, const WebPeer& peer) const {
  const auto token = JoinToken::Parse(text);
  if (!token) return token.error();
  return gate_->join(token->Key().PublicDigest(), peer.text);
}

HttpResponse WebSite::LogOut(const HttpRequest& request, const WebPeer& peer, const Visit& visit) {
  if (request.method != "POST") return HttpResponse::Plain(405, "Only POST is supported.\n");
  if (!IsOwnForm(request)) return ForeignForm();
  auto form = ParseForm(request.body);
  if (!form || !AreEqualSecrets((*form)["proof"], ProofFor("logout", visit.session))) return ForeignForm();
  sessions_.End(visit.session);
  gate_->leave(visit.visitor->member, peer.text);
  HttpResponse response = HttpResponse::Redirect("/login");
  response.cookie = fmt::format("{}=; {}; Max-Age=0", kSessionCookie, kCookieAttributes);
  return response;
}

// Only pages of this process can show it, to whoever has the secret as a cookie.
std::string WebSite::ProofFor(const char* purpose, const std::string& secret) const {
  return KeyedDigest(proof_key_, fmt::format("{}:{}", purpose, secret)).Hex();
}

}  // namespace tessera
