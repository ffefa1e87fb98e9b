// An HTTP/1 request, as far as the web pages need it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// Of the request line and all headers. Browsers send some hundred bytes.
constexpr size_t kHttpHeadBytesMax = 8 << 10;
// Of a body that is kept until it is whole: a form with a token has less than 1 KB. Longer ones are taken in
// pieces (BodySink).
constexpr size_t kHttpBodyBytesMax = 4 << 10;

struct HttpRequest {
  std::string method;
  std::string path;  // without the query
  std::string query;
  std::string authority;  // the header Host, in lower case; empty if it is missing
  std::string host;       // the same without the port
  std::string origin;     // the header Origin, in lower case
  std::string cookies;    // the header Cookie
  uint64_t body_size = 0;
  bool is_form = false;  // whether the body is one (form.h)
  bool is_json = false;
  std::string proof;          // the header X-Tessera-Proof
  std::string if_none_match;  // the header If-None-Match
  std::string body;           // empty if it is longer than kHttpBodyBytesMax
  bool has_long_body() const { return body_size > kHttpBodyBytesMax; }
};

// Parses a head, up to and including the empty line; the body is left to the caller. Returns nullopt if it is
// malformed, if one of these headers occurs twice, or if the size of the body is not stated.
std::optional<HttpRequest> ParseHttpRequest(std::string_view head);

// Whether a request that names `host` is meant for this server: a number, localhost or one of `names`. A page
// of another site can make a browser connect to any address under a name of that site, but not under these.
bool IsOwnHost(const std::string& host, const std::vector<std::string>& names);
bool IsNameOf(const std::string& host, const std::vector<std::string>& names);

}  // namespace tessera
