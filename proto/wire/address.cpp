#include "proto/wire/address.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/un.h>

#include <charconv>

namespace tessera {
namespace {

constexpr std::string_view kUnixPrefix = "unix:";
constexpr size_t kHostBytesMax = 253;  // RFC 1035
constexpr size_t kSocketPathMax = sizeof(sockaddr_un::sun_path) - 1;

Error BadAddress(const std::string& text, const std::string& what, const std::string& reason) {
  return BadInput(
      fmt::format("{}: bad address \"{}\": {}; expected HOST:PORT or unix:PATH", what, text, reason));
}

Result<Address> ParseUnix(const std::string& text, const std::string& what) {
  Address address;
  address.kind = Address::Kind::kUnix;
  address.path = text.substr(kUnixPrefix.size());
  if (address.path.empty()) return BadAddress(text, what, "the path is empty");
  if (address.path.size() > kSocketPathMax) {
    return BadAddress(text, what, fmt::format("the path of a socket has at most {} bytes", kSocketPathMax));
  }
  return address;
}

// Splits `text` at the colon between host and port. Returns false if it is malformed.
bool SplitHost(const std::string& text, std::string& host, std::string& port) {
  if (text.starts_with('[')) {
    const size_t close = text.find("]:");
    if (close == std::string::npos) return false;
    host = text.substr(1, close - 1);
    port = text.substr(close + 2);
    return host.find_first_not_of("0123456789abcdefABCDEF:.%") == std::string::npos;
  }
  const size_t colon = text.find(':');
  if (colon == std::string::npos || text.find(':', colon + 1) != std::string::npos) return false;
  host = text.substr(0, colon);
  port = text.substr(colon + 1);
  return host.find_first_of("[]/ \t\n") == std::string::npos;
}

}  // namespace

std::string Address::Text() const {
  if (kind == Kind::kUnix) return std::string(kUnixPrefix) + path;
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return is_ipv6 ? fmt::format("[{}]:{}", host, port) : fmt::format("{}:{}", host, port);
}

std::string Address::Target() const {
  return Text();
}

bool Address::IsLocal() const {
  if (kind == Kind::kUnix || host == "localhost" || host == "::1") return true;
  // A numeric IPv4 address in 127.0.0.0/8, not a name that starts like one.
  return host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string::npos;
}

Result<Address> ParseAddress(const std::string& text, const std::string& what) {
  if (text.starts_with(kUnixPrefix)) return ParseUnix(text, what);
  Address address;
  std::string port;
  if (!SplitHost(text, address.host, port)) return BadAddress(text, what, "malformed");
  if (address.host.empty()) return BadAddress(text, what, "the host is missing");
  if (address.host.size() > kHostBytesMax) return BadAddress(text, what, "the host name is too long");
  const char* const end = port.data() + port.size();
  const auto [stop, error] = std::from_chars(port.data(), end, address.port);
  if (error != std::errc() || stop != end || address.port < 0 || address.port > 65535) {
    return BadAddress(text, what, "the port is not a number from 0 to 65535");
  }
  return address;
}

}  // namespace tessera
