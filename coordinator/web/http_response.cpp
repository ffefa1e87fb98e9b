#include "coordinator/web/http_response.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "proto/identity/secrets.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

constexpr auto kReplaceInvalid = nlohmann::json::error_handler_t::replace;

// Outside of pages, scripts are not allowed at all, and a style sheet only if it is the one of the document:
// even a name that escaped its quotes could load and run nothing. A referrer policy that is stricter than
// same-origin would take the header Origin from forms.
constexpr const char* kHeaders =
    "X-Content-Type-Options: nosniff\r\n"
    "X-Frame-Options: DENY\r\n"
    "Referrer-Policy: same-origin\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Connection: close\r\n";

const char* PhraseOf(int status) {
  switch (status) {
    case 200: return "OK";
    case 303: return "See Other";
    case 304: return "Not Modified";
    case 400: return "Bad Request";
    case 401: return "Unauthorized";
    case 403: return "Forbidden";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 409: return "Conflict";
    case 413: return "Content Too Large";
    case 429: return "Too Many Requests";
    case 507: return "Insufficient Storage";
    case 431: return "Request Header Fields Too Large";
    default: return "Service Unavailable";
  }
}

// Pages load scripts, styles, pictures and data of this server alone. Trusted types forbid scripts to make
// markup of text, so not even a script that is wrong can turn the name of a job into an element.
constexpr const char* kPagePolicy =
    "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
    "connect-src 'self'; form-action 'self'; frame-ancestors 'none'; base-uri 'none'; "
    "require-trusted-types-for 'script'; trusted-types 'none'\r\n";

std::string SecurityPolicy(const HttpResponse& response) {
  if (response.is_page) return kPagePolicy;
  std::string source = "'none'";
  if (!response.style.empty()) {
    const Digest digest = Sha256(response.style);
    const std::string_view bytes(reinterpret_cast<const char*>(digest.bytes.data()), digest.bytes.size());
    source = fmt::format("'sha256-{}'", Base64(bytes));
  }
  return fmt::format(
      "Content-Security-Policy: default-src 'none'; style-src {}; form-action 'self'; frame-ancestors "
      "'none'; base-uri 'none'\r\n",
      source);
}

}  // namespace

HttpResponse HttpResponse::Plain(int status, std::string text) {
  return {.status = status, .body = std::make_shared<const std::string>(std::move(text))};
}

HttpResponse HttpResponse::Html(int status, std::string page, std::string style) {
  HttpResponse response = Plain(status, std::move(page));
  response.type = "text/html; charset=utf-8";
  response.style = std::move(style);
  return response;
}

HttpResponse HttpResponse::Bytes(std::string type, std::shared_ptr<const std::string> bytes) {
  return {.type = std::move(type), .body = std::move(bytes)};
}

HttpResponse HttpResponse::JsonError(int status, const std::string& reason) {
  HttpResponse response =
      Plain(status, nlohmann::json{{"error", reason}}.dump(-1, ' ', false, kReplaceInvalid) + "\n");
  response.type = kJsonText;
  return response;
}

HttpResponse HttpResponse::Unsupported(const std::string& methods) {
  HttpResponse response = Plain(405, fmt::format("Only {} is supported.\n", methods));
  response.allow = methods;
  return response;
}

HttpResponse HttpResponse::Redirect(std::string path) {
  HttpResponse response = Plain(303, "");
  response.location = std::move(path);
  return response;
}

HttpResponse HttpResponse::Stream(std::string type, std::shared_ptr<BodyStream> stream) {
  return {.type = std::move(type), .body = nullptr, .stream = std::move(stream)};
}

HttpResponse HttpResponse::Later(std::shared_ptr<LaterAnswer> later) {
  return {.body = nullptr, .later = std::move(later)};
}

HttpResponse HttpResponse::Receive(std::shared_ptr<BodySink> sink) {
  return {.body = nullptr, .sink = std::move(sink)};
}

HttpResponse HttpResponse::Continue() {
  return {.status = kContinue, .body = nullptr};
}

// The end of a stream whose size is not known is that of its connection.
std::string HttpResponse::Head() const {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\n", status, PhraseOf(status), type);
  if (stream == nullptr) head += fmt::format("Content-Length: {}\r\n", body->size());
  if (stream_size) head += fmt::format("Content-Length: {}\r\n", *stream_size);
  head += SecurityPolicy(*this);
  head += kHeaders;
  // Browsers may keep what never holds data of the farm, and ask each time whether it is still the same.
  head += etag.empty() ? "Cache-Control: no-store\r\n"
                       : fmt::format("Cache-Control: private, no-cache\r\nETag: {}\r\n", etag);
  if (status == 401) head += "WWW-Authenticate: ClientCertificate realm=\"farm\"\r\n";
  if (status == 405) head += fmt::format("Allow: {}\r\n", allow.empty() ? "GET, HEAD" : allow);
  if (!location.empty()) head += fmt::format("Location: {}\r\n", location);
  if (!cookie.empty()) head += fmt::format("Set-Cookie: {}\r\n", cookie);
  if (!file_name.empty())
    head += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", file_name);
  return head + "\r\n";
}

void LaterAnswer::Give(HttpResponse response) {
  Give([response = std::move(response)] { return response; });
}

void LaterAnswer::Give(std::function<HttpResponse()> make) {
  std::function<void()> notify;
  {
    const std::lock_guard lock(mutex_);
    if (is_given_) return;
    is_given_ = true;
    make_ = std::move(make);
    notify = notify_;
  }
  if (notify) notify();
}

void LaterAnswer::OnGiven(const std::function<void()>& notify) {
  bool is_given = false;
  {
    const std::lock_guard lock(mutex_);
    is_given = make_ != nullptr;
    notify_ = notify;
  }
  if (is_given) notify();
}

std::optional<HttpResponse> LaterAnswer::Take() {
  std::function<HttpResponse()> make;
  {
    const std::lock_guard lock(mutex_);
    make = std::exchange(make_, nullptr);
  }
  if (!make) return std::nullopt;
  return finish_ ? finish_(make()) : make();
}

}  // namespace tessera
