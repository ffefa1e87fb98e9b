#include "coordinator/web/api/body_routes.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "coordinator/web/api/job_order.h"
#include "coordinator/web/api/json_views.h"
#include "coordinator/web/api/parameters.h"

namespace tessera {
namespace {

using nlohmann::json;
using Answer = std::shared_ptr<LaterAnswer>;

// Takes a JSON object, which comes in one piece.
class JsonSink final : public BodySink {
 public:
  using Run = std::function<void(const json& body, const Answer& answer)>;
  explicit JsonSink(Run run) : run_(std::move(run)) {}
  void Take(std::string piece, bool, Answer answer) override {
    const json body = json::parse(piece, nullptr, false);
    if (!body.is_object()) return answer->Give(HttpResponse::JsonError(400, "the body is not a JSON object"));
    run_(body, answer);
  }

 private:
  const Run run_;
};

WebResult<std::vector<Digest>> ReadDigests(const json& body) {
  const auto member = body.find("digests");
  if (body.size() != 1 || member == body.end() || !member->is_array())
    return WebError{400, "expected the member digests, an array"};
  if (member->size() > kWebDigestsMax)
    return WebError{400, fmt::format("digests: at most {} in one request", kWebDigestsMax)};
  std::vector<Digest> digests;
  for (const json& each : *member) {
    const auto digest = each.is_string() ? Digest::FromHex(each.get_ref<const std::string&>()) : std::nullopt;
    if (!digest) return WebError{400, "digests: expected texts of 64 hexadecimal digits"};
    digests.push_back(*digest);
  }
  return digests;
}

HttpResponse ShowMissing(const WebResult<std::map<Digest, uint64_t>>& found) {
  if (const auto* const error = std::get_if<WebError>(&found))
    return HttpResponse::JsonError(error->status, error->reason);
  json missing = json::array();
  for (const auto& [digest, held] : std::get<std::map<Digest, uint64_t>>(found))
    missing.push_back({{"digest", digest.Hex()}, {"held", held}});
  HttpResponse response = HttpResponse::Plain(200, JsonText({{"missing", std::move(missing)}}) + "\n");
  response.type = kJsonText;
  return response;
}

void FindMissing(const WebFarm& farm, const json& body, const Answer& answer) {
  const auto digests = ReadDigests(body);
  if (const auto* const error = std::get_if<WebError>(&digests))
    return answer->Give(HttpResponse::JsonError(error->status, error->reason));
  farm.find_missing(std::get<std::vector<Digest>>(digests),
                    [answer](const auto& found) { answer->Give([found] { return ShowMissing(found); }); });
}

HttpResponse ShowJob(const WebResult<JobStatus>& ordered) {
  if (const auto* const error = std::get_if<WebError>(&ordered))
    return HttpResponse::JsonError(error->status, error->reason);
  HttpResponse response = HttpResponse::Plain(200, JsonText(JobJson(std::get<JobStatus>(ordered))) + "\n");
  response.type = kJsonText;
  return response;
}

void OrderJob(const WebFarm& farm, const WebCaller& caller, const json& body, const Answer& answer) {
  const auto order = ReadJobOrder(body);
  if (const auto* const error = std::get_if<WebError>(&order))
    return answer->Give(HttpResponse::JsonError(error->status, error->reason));
  farm.order_job(caller, std::get<JobOrder>(order),
                 [answer](const auto& ordered) { answer->Give([ordered] { return ShowJob(ordered); }); });
}

WebResult<std::shared_ptr<BodySink>> ReceiveBlob(const WebFarm& farm, const HttpRequest& http,
                                                 const WebRouteMatch& match, const WebCaller& caller) {
  const auto query = ReadParameters(http, *match.route);
  if (const auto* const error = std::get_if<WebError>(&query)) return *error;
  uint64_t offset = 0;
  if (!ReadNumber(std::get<Query>(query), "offset", kBlobBytesMax, offset) ||
      http.body_size > kBlobBytesMax - offset)
    return WebError{400, fmt::format("a file may have {} bytes", kBlobBytesMax)};
  return farm.receive_blob(caller, match.blob, offset + http.body_size, offset);
}

}  // namespace

WebResult<std::shared_ptr<BodySink>> MakeBodySink(const WebFarm& farm, const HttpRequest& http,
                                                  const WebRouteMatch& match, const WebCaller& caller) {
  if (match.route->body == WebBody::kBytes) return ReceiveBlob(farm, http, match, caller);
  if (!http.is_json) return WebError{400, "the body is not a JSON object"};
  if (http.body_size > kBodyPieceBytes) return WebError{413, "the request is too long"};
  if (!http.query.empty()) return WebError{400, "the call takes no query"};
  if (match.route->action == WebAction::kOrderJob)
    return std::make_shared<JsonSink>(
        [&farm, caller](const json& body, const Answer& answer) { OrderJob(farm, caller, body, answer); });
  return std::make_shared<JsonSink>(
      [&farm](const json& body, const Answer& answer) { FindMissing(farm, body, answer); });
}

}  // namespace tessera
