// --notify-command: a command of the user that is run when a job has ended.
#pragma once

#include <string>

#include "proto/terms.h"

namespace tessera {

// What the command finds in its environment.
struct Notice {
  std::string job;     // $TESSERA_JOB_ID: the id; empty for a render without a farm
  std::string name;    // $TESSERA_JOB_NAME
  std::string state;   // $TESSERA_JOB_STATE: finished, failed or cancelled
  std::string reason;  // $TESSERA_JOB_REASON: why it failed, or empty
};
Notice NoticeOf(const JobStatus& status);

// Runs the command with /bin/sh and waits for it. What it prints goes to stderr. Names and reasons come from
// others: they are only in the environment, never in the command. A command that fails is a warning. Does
// nothing if `command` is empty.
void RunNotifyCommand(const std::string& command, const Notice& notice);

}  // namespace tessera
