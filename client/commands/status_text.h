// Jobs and workers in words for people and in JSON for machines.
#pragma once

#include <string>
#include <vector>

#include "client/progress_line.h"
#include "proto/terms.h"

namespace tessera {

Progress ProgressOf(const JobStatus& status);
// `job 3 "cornell": running, 43.1 % ...`
std::string JobText(const JobStatus& status);
std::string JobTable(const std::vector<JobStatus>& jobs);
std::string WorkerTable(const std::vector<WorkerStatus>& workers);
// Durations in seconds; "left_s" is null while it is not known.
std::string JobJson(const JobStatus& status);
std::string JobsJson(const std::vector<JobStatus>& jobs);
std::string WorkersJson(const std::vector<WorkerStatus>& workers);

}  // namespace tessera
