// The farm as a former process left it in the data directory.
#pragma once

#include "coordinator/core_thread.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/store/file_spool.h"
#include "renderer/util/result.h"

namespace tessera {

struct RecoveryOptions {
  int attempts_max = kAttemptsMaxDefault;
  uint64_t keep_sums_bytes = kKeptBytesMaxDefault;
};

// Farm, journal and spool of a data directory, old or new. An error that names the file if one is damaged.
// `run` runs what the spool does in the background.
Result<CoreThread::Parts> Recover(const DataDir& directory, const RecoveryOptions& options,
                                  FileSpool::Run run);

}  // namespace tessera
