#include "coordinator/web/web_site.h"

#include <fmt/format.h>

#include "coordinator/web/form.h"
#include "coordinator/web/metrics_text.h"
#include "coordinator/web/page_style.h"
#include "proto/identity/join_token.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Pages are not made more often than this, however many ask for them.
constexpr std::chrono::milliseconds kPageAge{250};
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

// Whether the form was sent by a page of this server.
bool IsOwnForm(const HttpRequest& request) {
  return request.is_form && !request.authority.empty() && request.origin == "https://" + request.authority;
}

HttpResponse ForeignForm() {
  return HttpResponse::Plain(403, "The form was not sent by a page of this server.\n");
}

}  // namespace

WebSite::WebSite(std::vector<std::string> names, Look look, std::optional<WebGate> gate)
    : names_(std::move(names)), look_(std::move(look)), gate_(std::move(gate)), logins_(kLoginLimits) {}

HttpResponse WebSite::Answer(const HttpRequest& request, const WebPeer& peer, TimePoint now) {
  if (!IsForUs(request, peer))
    return HttpResponse::Plain(403, "The page is not served under this name; see --http-name.\n");
  if (!gate_) return ShowPage(request, {}, now);
  if (request.query.find(kTokenPrefix) != std::string::npos) {
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
  PageReader reader{visit.visitor->name, visit.visitor->role, ""};
  if (!visit.session.empty()) reader.logout_proof = ProofFor("logout", visit.session);
  HttpResponse response = ShowPage(request, reader, now);
  response.is_for_member = true;
  return response;
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

HttpResponse WebSite::ShowPage(const HttpRequest& request, const PageReader& reader, TimePoint now) {
  const bool is_page = request.path == "/";
  if (!is_page && request.path != "/metrics") return HttpResponse::Plain(404, "There is no such page.\n");
  if (!IsGet(request)) return HttpResponse::Plain(405, "Only GET is supported.\n");
  const Page& page = PageAt(request.path, now);
  if (is_page && page.status == 200)
    return HttpResponse::Html(200, StatusPage(*page.body, reader), kPageStyle);
  const char* const type = page.status == 200 ? "text/plain; version=0.0.4; charset=utf-8" : kPlainText;
  return {page.status, type, page.body, "", "", "", false};
}

HttpResponse WebSite::LoginForm(const HttpRequest& request, int status, const std::string& problem) const {
  std::string secret = CookieValue(request.cookies, kFormCookie);
  if (secret.size() != kSecretSize) secret = RandomSecret();
  HttpResponse response =
      HttpResponse::Html(status, LoginPage(ProofFor("login", secret), problem), kPageStyle);
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

const WebSite::Page& WebSite::PageAt(const std::string& path, TimePoint now) {
  Page& page = pages_[path];
  if (page.body != nullptr && now - page.made < kPageAge) return page;
  const auto view = look_();
  page.status = view ? 200 : 503;
  page.body = std::make_shared<const std::string>(!view         ? "The coordinator is busy. Try again.\n"
                                                  : path == "/" ? StatusContent(*view)
                                                                : MetricsText(*view));
  page.made = now;
  return page;
}

}  // namespace tessera
