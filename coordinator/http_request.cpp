#include "coordinator/http_request.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>

namespace tessera {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

std::string_view Trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// The text up to `separator`, which is removed with it; nullopt if there is none.
std::optional<std::string_view> Take(std::string_view& text, std::string_view separator) {
  const size_t end = text.find(separator);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(end + separator.size());
  return taken;
}

std::string WithoutPort(std::string_view host) {
  const size_t bracket = host.rfind(']');
  const size_t colon = host.rfind(':');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
  return Lower(has_port ? host.substr(0, colon) : host);
}

bool IsNumber(const std::string& host) {
  in_addr ipv4{};
  in6_addr ipv6{};
  if (::inet_pton(AF_INET, host.c_str(), &ipv4) == 1) return true;
  const bool has_brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  return has_brackets && ::inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &ipv6) == 1;
}

}  // namespace

std::optional<HttpRequest> ParseHttpRequest(std::string_view head) {
  HttpRequest request;
  auto line = Take(head, kLineEnd);
  if (!line) return std::nullopt;
  const auto method = Take(*line, " ");
  const auto target = Take(*line, " ");
  if (!method || method->empty() || !target || !target->starts_with('/') || !line->starts_with("HTTP/1."))
    return std::nullopt;
  request.method = *method;
  request.path = target->substr(0, target->find('?'));
  size_t hosts = 0;
  while (true) {
    auto header = Take(head, kLineEnd);
    if (!header) return std::nullopt;
    if (header->empty()) break;
    const auto name = Take(*header, ":");
    if (!name || name->empty()) return std::nullopt;
    if (Lower(*name) != "host") continue;
    ++hosts;
    request.host = WithoutPort(Trim(*header));
  }
  if (hosts > 1) return std::nullopt;
  return request;
}

bool IsOwnHost(const std::string& host, const std::vector<std::string>& names) {
  if (host == "localhost" || IsNumber(host)) return true;
  return std::ranges::any_of(names, [&](const std::string& name) { return Lower(name) == host; });
}

}  // namespace tessera
