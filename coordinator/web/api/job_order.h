// A job that a page submits, as JSON. coordinator/page/openapi.json explains every member.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "coordinator/web/api/web_farm.h"
#include "proto/terms.h"

namespace tessera {

// An error (status 400) that names the member that is missing, unknown or out of range. Without a submission
// number, that of the order is 0.
WebResult<JobOrder> ReadJobOrder(const nlohmann::json& body);

}  // namespace tessera
