#include "coordinator/web/http_response.h"

#include <fmt/format.h>

#include "proto/identity/secrets.h"
#include "renderer/util/digest.h"

namespace tessera {
namespace {

// Scripts are not allowed at all, and a style sheet only if it is the one of the page: even a name that
// escaped its quotes could load and run nothing. A referrer policy that is stricter than same-origin would
// take the header Origin from forms.
constexpr const char* kHeaders =
    "X-Content-Type-Options: nosniff\r\n"
    "X-Frame-Options: DENY\r\n"
    "Referrer-Policy: same-origin\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cache-Control: no-store\r\n"
    "Connection: close\r\n";

const char* PhraseOf(int status) {
  switch (status) {
    case 200: return "OK";
    case 303: return "See Other";
    case 400: return "Bad Request";
    case 401: return "Unauthorized";
    case 403: return "Forbidden";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 413: return "Content Too Large";
    case 429: return "Too Many Requests";
    case 431: return "Request Header Fields Too Large";
    default: return "Service Unavailable";
  }
}

std::string SecurityPolicy(const std::string& style) {
  std::string source = "'none'";
  if (!style.empty()) {
    const Digest digest = Sha256(style);
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
  return {status, kPlainText, std::make_shared<const std::string>(std::move(text)), "", "", "", false};
}

HttpResponse HttpResponse::Html(int status, std::string page, std::string style) {
  return {status,
          "text/html; charset=utf-8",
          std::make_shared<const std::string>(std::move(page)),
          std::move(style),
          "",
          "",
          false};
}

HttpResponse HttpResponse::Redirect(std::string path) {
  HttpResponse response = Plain(303, "");
  response.location = std::move(path);
  return response;
}

std::string HttpResponse::Head() const {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}{}", status,
                                 PhraseOf(status), type, body->size(), SecurityPolicy(style), kHeaders);
  if (status == 401) head += "WWW-Authenticate: ClientCertificate realm=\"farm\"\r\n";
  if (status == 405) head += "Allow: GET, HEAD\r\n";
  if (!location.empty()) head += fmt::format("Location: {}\r\n", location);
  if (!cookie.empty()) head += fmt::format("Set-Cookie: {}\r\n", cookie);
  return head + "\r\n";
}

}  // namespace tessera
