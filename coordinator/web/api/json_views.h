// What the interface for programs shows, as JSON. coordinator/page/openapi.json explains every member. Pure
// functions.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/web/api/farm_watch.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

using Query = std::map<std::string, std::string>;

// Text from outside that is not UTF-8 is shown with replacement characters.
std::string JsonText(const nlohmann::json& json);

nlohmann::json JobJson(const JobStatus& job);
// `view`: the farm a moment ago, for the names of workers; may be null.
nlohmann::json DetailJson(const JobDetail& detail, const FarmView* view);
nlohmann::json JobLogJson(const JobLogPage& page);
nlohmann::json WorkerJson(const WorkerStatus& worker);
nlohmann::json FarmJson(const FarmMoment& moment);
nlohmann::json HistoryJson(const std::vector<HistoryPoint>& history);

// A page of the jobs or workers that the query selects, sorted as it says, and the number of all of these. An
// error (status 400) that names the parameter that is wrong.
WebResult<nlohmann::json> JobsJson(const FarmView& view, const Query& query);
WebResult<nlohmann::json> WorkersJson(const FarmWatch& watch, const FarmView& view, const Query& query);

// A parameter that is a number within limits; `number` if it is missing. Returns whether it is right.
bool ReadNumber(const Query& query, const char* name, uint64_t max, uint64_t& number);

}  // namespace tessera
