#include "coordinator/web/http_request.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

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
  return std::string(has_port ? host.substr(0, colon) : host);
}

bool IsNumber(const std::string& host) {
  in_addr ipv4{};
  in6_addr ipv6{};
  if (::inet_pton(AF_INET, host.c_str(), &ipv4) == 1) return true;
  const bool has_brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  return has_brackets && ::inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &ipv6) == 1;
}

bool ReadSize(std::string_view text, uint64_t& size) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  return error == std::errc() && end == text.data() + text.size();
}

// Headers that may occur once.
bool IsSingle(const std::string& name) {
  return name == "host" || name == "origin" || name == "cookie" || name == "x-tessera-proof" ||
         name.starts_with("content-");
}

// Whether the header is well-formed as far as it is known.
bool ReadHeader(const std::string& name, std::string_view value, HttpRequest& request) {
  if (name == "host") {
    request.authority = Lower(value);
  } else if (name == "origin") {
    request.origin = Lower(value);
  } else if (name == "cookie") {
    request.cookies = value;
  } else if (name == "content-type") {
    const std::string type = Lower(Trim(value.substr(0, value.find(';'))));
    request.is_form = type == "application/x-www-form-urlencoded";
    request.is_json = type == "application/json";
  } else if (name == "x-tessera-proof") {
    request.proof = value;
  } else if (name == "if-none-match") {
    request.if_none_match = value;
  } else if (name == "content-length") {
    return ReadSize(value, request.body_size);
  }
  return name != "transfer-encoding";
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
  const size_t path_end = std::min(target->find('?'), target->size());
  request.path = target->substr(0, path_end);
  request.query = target->substr(std::min(path_end + 1, target->size()));
  std::set<std::string> seen;
  while (true) {
    auto header = Take(head, kLineEnd);
    if (!header) return std::nullopt;
    if (header->empty()) break;
    const auto name = Take(*header, ":");
    if (!name || name->empty()) return std::nullopt;
    const std::string lower = Lower(*name);
    if (IsSingle(lower) && !seen.insert(lower).second) return std::nullopt;
    if (!ReadHeader(lower, Trim(*header), request)) return std::nullopt;
  }
  request.host = WithoutPort(request.authority);
  return request;
}

bool IsOwnHost(const std::string& host, const std::vector<std::string>& names) {
  return host == "localhost" || IsNumber(host) || IsNameOf(host, names);
}

bool IsNameOf(const std::string& host, const std::vector<std::string>& names) {
  return std::ranges::any_of(names, [&](const std::string& name) { return Lower(name) == host; });
}

}  // namespace tessera
