// What a request of the interface says besides its path: the fields of its query, or the members of its body.
#pragma once

#include <map>
#include <string>

#include "coordinator/web/api/routes.h"
#include "coordinator/web/api/web_farm.h"
#include "coordinator/web/http_request.h"

namespace tessera {

using Query = std::map<std::string, std::string>;

// Changes have a body: a JSON object of whole numbers, which become text. All others have a query. The error
// names what is wrong; a parameter that the route does not list is refused.
WebResult<Query> ReadParameters(const HttpRequest& http, const WebRoute& route);

// A parameter that is a number within limits; `number` if it is missing. Returns whether it is right.
bool ReadNumber(const Query& query, const char* name, uint64_t max, uint64_t& number);

}  // namespace tessera
