#include <algorithm>
#include <charconv>

#include <nlohmann/json.hpp>

#include "coordinator/store/message_file.h"
#include "coordinator/web/api/job_order.h"
#include "coordinator/web/api/parameters.h"
#include "renderer/scene/scene.h"
#include "renderer/util/check.h"
#include "tests/fuzz/targets.h"

namespace tessera {
namespace {

// An order is within its limits, and its options are written as everybody writes them: a worker that reads
// them writes the same again.
bool ReadsOrder(const std::string& body) {
  const auto json = nlohmann::json::parse(body, nullptr, false);
  if (!json.is_object()) return false;
  const auto read = ReadJobOrder(json);
  if (const auto* const error = std::get_if<WebError>(&read)) {
    TESSERA_CHECK(error->status == 400 && !error->reason.empty());
    return false;
  }
  const auto& order = std::get<JobOrder>(read);
  TESSERA_CHECK(CheckSceneOrder(order.scene).has_value());
  const auto options = DecodeRenderOptions(order.scene.options);
  if (options) TESSERA_CHECK(EncodeRenderOptions(*options) == order.scene.options);
  return true;
}

}  // namespace

// A line "METHOD PATH?QUERY", then the body, as the interface for programs gets them after the head was
// parsed.
bool FuzzWebCall(std::string_view bytes) {
  const size_t end = std::min(bytes.find('\n'), bytes.size());
  const std::string_view line = bytes.substr(0, end);
  HttpRequest http;
  http.method = line.substr(0, line.find(' '));
  http.path = line.size() > http.method.size() ? line.substr(http.method.size() + 1) : "";
  if (const size_t mark = http.path.find('?'); mark != std::string::npos) {
    http.query = http.path.substr(mark + 1);
    http.path.resize(mark);
  }
  http.body = bytes.substr(std::min(end + 1, bytes.size()));
  http.is_json = true;
  std::string methods;
  const auto match = FindRoute(http.method, http.path, methods);
  if (!match) return false;
  const WebRoute& route = *match->route;
  TESSERA_CHECK(methods.empty() && (route.method == http.method || http.method == "HEAD"));
  TESSERA_CHECK(route.path.find("{job}") == std::string_view::npos || match->job != JobId{});
  if (route.action == WebAction::kOrderJob) return ReadsOrder(http.body);
  const auto parameters = ReadParameters(http, route);
  const auto* const read = std::get_if<Query>(&parameters);
  if (read == nullptr) {
    TESSERA_CHECK(std::get<WebError>(parameters).status == 400);
    return false;
  }
  for (const auto& [name, value] : *read) {
    TESSERA_CHECK(IsListed(route.parameters, name));
    if (route.method != "POST") continue;
    TESSERA_CHECK(!value.empty() &&
                  std::ranges::all_of(value.substr(1), [](char c) { return c >= '0' && c <= '9'; }));
  }
  return true;
}

// A message of the log of a job, as it is stored.
bool FuzzJobMessage(std::string_view bytes) {
  const auto message = DecodeMessage(bytes);
  if (!message) return false;
  const auto again = DecodeMessage(EncodeMessage(*message));
  TESSERA_CHECK(again && again->entry == message->entry && again->job == message->job &&
                again->submission == message->submission);
  return true;
}

}  // namespace tessera
