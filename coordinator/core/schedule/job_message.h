// What people are told about a job: what changed, what failed and what is out of the ordinary. Unlike the
// coordinator's own log, each message belongs to one job and is a sentence without ids of the program.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/terms.h"

namespace tessera {

struct JobMessage {
  JobId job{};
  MessageLevel level = MessageLevel::kInfo;
  std::string text;
  // Whether the job has ended with this, or is open from now on.
  enum class Change { kOpens, kEnds };
  std::optional<Change> change = std::nullopt;
  // Of the JobSpec: a data directory that is restored to an earlier state uses numbers of jobs again.
  uint64_t submission = 0;
};

// "tile 17 of frame 3, samples [64,128)", by the number that the user gave the frame.
std::string UnitText(const JobSpec& spec, const WorkUnit& unit);

}  // namespace tessera
