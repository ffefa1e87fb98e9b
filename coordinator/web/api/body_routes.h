// Requests whose bodies are more than a few numbers: files that are uploaded, and JSON documents.
#pragma once

#include <memory>

#include "coordinator/web/api/routes.h"
#include "coordinator/web/api/web_farm.h"
#include "coordinator/web/http_request.h"

namespace tessera {

// In one request: 67 KB of JSON.
constexpr size_t kWebDigestsMax = 1000;

// What takes the body of a request for a route with such a body, whose caller was admitted, and answers it.
// An error if the head tells that the request is wrong. `farm` must outlive it.
WebResult<std::shared_ptr<BodySink>> MakeBodySink(const WebFarm& farm, const HttpRequest& http,
                                                  const WebRouteMatch& match, const WebCaller& caller);

}  // namespace tessera
