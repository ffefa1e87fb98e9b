// The status of jobs and workers as text for people and as JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "client/commands/top_text.h"
#include "client/progress_line.h"
#include "proto/terms.h"

namespace tessera {

Progress ProgressOf(const JobStatus& status);
// `job 3 "cornell": running, 43.1 % ...`
std::string JobText(const JobStatus& status);
std::string JobTable(const std::vector<JobStatus>& jobs);
std::string WorkerTable(const std::vector<WorkerStatus>& workers);
// Durations are in seconds. "left_s" is null if unknown.
std::string JobJson(const JobStatus& status);
std::string JobsJson(const std::vector<JobStatus>& jobs);
std::string WorkersJson(const std::vector<WorkerStatus>& workers);
std::string FarmJson(const FarmView& view);

}  // namespace tessera
