// What the interface for programs shows, as JSON. coordinator/page/openapi.json explains every member. Pure
// functions.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/web/api/farm_watch.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

// Text from outside that is not UTF-8 is shown with replacement characters.
std::string JsonText(const nlohmann::json& json);

nlohmann::json JobJson(const JobStatus& job);
// `view`: the farm a moment ago, for the names of workers; may be null.
nlohmann::json DetailJson(const JobDetail& detail, const FarmView* view);
nlohmann::json JobLogJson(const JobLogPage& page);
nlohmann::json WorkerJson(const WorkerStatus& worker);
nlohmann::json FarmJson(const FarmMoment& moment);
nlohmann::json HistoryJson(const std::vector<HistoryPoint>& history);

// "rendering", "idle", "quarantined", ...
const char* StateOf(const WorkerStatus& worker);
// From 0 to 1.
double ProgressOf(const JobStatus& job);

}  // namespace tessera
