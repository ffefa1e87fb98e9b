#include "coordinator/web/api/routes.h"

#include <charconv>

namespace tessera {
namespace {

constexpr size_t kWorkerDigits = 16;

// The text up to the next slash, which is removed with it.
std::string_view TakeSegment(std::string_view& path) {
  const size_t end = path.find('/');
  const std::string_view segment = path.substr(0, end);
  path.remove_prefix(end == std::string_view::npos ? path.size() : end + 1);
  return segment;
}

bool ReadJob(std::string_view text, JobId& job) {
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || text.starts_with('0')) return false;
  job = JobId{number};
  return true;
}

bool ReadWorker(std::string_view text, std::string& worker) {
  worker = text;
  return text.size() == kWorkerDigits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool ReadBlob(std::string_view text, Digest& blob) {
  const auto digest = Digest::FromHex(text);
  if (!digest || digest->Hex() != text) return false;
  blob = *digest;
  return true;
}

bool Matches(std::string_view pattern, std::string_view path, WebRouteMatch& match) {
  while (!pattern.empty() && !path.empty()) {
    const std::string_view expected = TakeSegment(pattern), segment = TakeSegment(path);
    const bool is_same = expected == "{job}"      ? ReadJob(segment, match.job)
                         : expected == "{worker}" ? ReadWorker(segment, match.worker)
                         : expected == "{blob}"   ? ReadBlob(segment, match.blob)
                                                  : expected == segment;
    if (!is_same) return false;
  }
  return pattern.empty() && path.empty();
}

}  // namespace

std::optional<WebRouteMatch> FindRoute(std::string_view method, std::string_view path, std::string& methods) {
  if (path.ends_with('/')) return std::nullopt;
  const std::string_view wanted = method == "HEAD" ? "GET" : method;
  for (const WebRoute& route : kWebRoutes) {
    WebRouteMatch match{&route, {}, {}, {}};
    if (!Matches(route.path, path, match)) continue;
    if (route.method == wanted) {
      methods.clear();
      return match;
    }
    const std::string more = route.method == "GET" ? "GET, HEAD" : std::string(route.method);
    methods += methods.empty() ? more : ", " + more;
  }
  return std::nullopt;
}

bool IsListed(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const size_t end = list.find(' ');
    if (!word.empty() && list.substr(0, end) == word) return true;
    list.remove_prefix(end == std::string_view::npos ? list.size() : end + 1);
  }
  return false;
}

}  // namespace tessera
