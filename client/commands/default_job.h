// The job of a command whose user names none.
#pragma once

#include <optional>
#include <vector>

#include "client/commands/option_groups.h"
#include "client/coordinator/coordinator_client.h"
#include "proto/membership.h"
#include "proto/terms.h"

namespace tessera {

// Returns the only open job of this owner, or the one that was submitted last if all have ended. `jobs` are
// in the order of their submission. Fails if there is none or if several are open, which the error lists.
Result<JobId> DefaultJob(const std::vector<JobStatus>& jobs, MemberId owner);

// Returns `named` or, if it is empty, the default job of this user, which is printed on stderr.
Result<JobId> ChooseJob(CoordinatorClient& client, const ConnectionOptions& connection,
                        const std::optional<JobId>& named);

}  // namespace tessera
