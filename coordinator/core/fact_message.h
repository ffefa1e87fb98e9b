// Messages to people (job_message.h) that follow from facts: submitted, paused, extended, finished, ...
#pragma once

#include <optional>

#include "coordinator/core/fact.h"
#include "coordinator/core/job_table.h"
#include "coordinator/core/schedule/job_message.h"

namespace tessera {

// Returns nullopt if the fact says nothing about a job that the table has, or nothing to people.
std::optional<JobMessage> MessageOf(const Fact& fact, const JobTable& jobs);

}  // namespace tessera
