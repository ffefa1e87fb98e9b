// Lists of jobs and workers as JSON, page by page. Pure functions.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "coordinator/web/api/farm_watch.h"
#include "coordinator/web/api/parameters.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

// A page of the jobs or workers that the query selects, sorted as it says, and the number of all of these. An
// error (status 400) that names the parameter that is wrong.
WebResult<nlohmann::json> JobsJson(const FarmView& view, const Query& query);
WebResult<nlohmann::json> WorkersJson(const FarmWatch& watch, const FarmView& view, const Query& query);

}  // namespace tessera
