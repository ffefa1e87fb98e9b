#include "coordinator/web/api/parameters.h"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "coordinator/web/form.h"

namespace tessera {
namespace {

using nlohmann::json;

// The members of a JSON object, numbers as text. Returns nullopt if the body is anything else.
std::optional<Query> ReadBody(const HttpRequest& http) {
  if (http.body.empty()) return Query();
  if (!http.is_json) return std::nullopt;
  const json body = json::parse(http.body, nullptr, false);
  if (!body.is_object()) return std::nullopt;
  Query members;
  for (const auto& [name, value] : body.items()) {
    if (!value.is_number_integer()) return std::nullopt;
    members[name] = value.dump();
  }
  return members;
}

}  // namespace

WebResult<Query> ReadParameters(const HttpRequest& http, const WebRoute& route) {
  const bool is_change = route.method == "POST";
  if (is_change && !http.query.empty()) return WebError{400, "the call takes no query"};
  auto parameters = is_change ? ReadBody(http) : ParseForm(http.query);
  if (!parameters)
    return WebError{400,
                    is_change ? "the body is not a JSON object of whole numbers" : "the query is malformed"};
  for (const auto& [name, value] : *parameters) {
    if (!IsListed(route.parameters, name))
      return WebError{400, fmt::format("unknown parameter; expected {}",
                                       route.parameters.empty() ? "none" : route.parameters)};
  }
  return std::move(*parameters);
}

bool ReadNumber(const Query& query, const char* name, uint64_t max, uint64_t& number) {
  const auto found = query.find(name);
  if (found == query.end()) return true;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number <= max;
}

}  // namespace tessera
