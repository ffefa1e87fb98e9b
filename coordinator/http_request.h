// The head of an HTTP/1 request, as far as the status page needs it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// Of the request line and all headers. Browsers send some hundred bytes.
constexpr size_t kHttpHeadBytesMax = 8 << 10;

struct HttpRequest {
  std::string method;
  std::string path;  // without the query
  std::string host;  // of the header Host, without the port; empty if it is missing
};

// Parses a head, up to and including the empty line. Returns nullopt if it is malformed.
std::optional<HttpRequest> ParseHttpRequest(std::string_view head);

// Whether a request that names `host` is meant for this server: a number, localhost or one of `names`. A page
// of another site can make a browser connect to any address under a name of that site, but not under these.
bool IsOwnHost(const std::string& host, const std::vector<std::string>& names);

}  // namespace tessera
