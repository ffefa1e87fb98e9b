// The commands of `tessera`, one file each. A command prints its answer on stdout and everything else on
// stderr, and gives the exit code; its errors are printed by main.
#pragma once

#include "client/cancellation.h"
#include "client/options.h"

namespace tessera {

using Command = Result<int> (*)(const Options& options, Cancellation& cancellation);

Result<int> RunRender(const Options& options, Cancellation& cancellation);
Result<int> RunSubmit(const Options& options, Cancellation& cancellation);
Result<int> RunStatus(const Options& options, Cancellation& cancellation);
Result<int> RunWatch(const Options& options, Cancellation& cancellation);
Result<int> RunCancel(const Options& options, Cancellation& cancellation);
Result<int> RunExtend(const Options& options, Cancellation& cancellation);
Result<int> RunPause(const Options& options, Cancellation& cancellation);
Result<int> RunResume(const Options& options, Cancellation& cancellation);
Result<int> RunPriority(const Options& options, Cancellation& cancellation);
Result<int> RunFetch(const Options& options, Cancellation& cancellation);
Result<int> RunJobs(const Options& options, Cancellation& cancellation);
Result<int> RunWorkers(const Options& options, Cancellation& cancellation);
Result<int> RunDrain(const Options& options, Cancellation& cancellation);
Result<int> RunRelease(const Options& options, Cancellation& cancellation);
Result<int> RunCompare(const Options& options, Cancellation& cancellation);
Result<int> RunInfo(const Options& options, Cancellation& cancellation);

}  // namespace tessera
