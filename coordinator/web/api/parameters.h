// What a request of the interface says besides its path: the fields of its query, or the members of its body.
#pragma once

#include "coordinator/web/api/json_views.h"
#include "coordinator/web/api/routes.h"
#include "coordinator/web/http_request.h"

namespace tessera {

// Changes have a body: a JSON object of whole numbers, which become text. All others have a query. The error
// names what is wrong; a parameter that the route does not list is refused.
WebResult<Query> ReadParameters(const HttpRequest& http, const WebRoute& route);

}  // namespace tessera
