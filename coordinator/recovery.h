// The farm as a former process left it in the data directory.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/core/journal.h"
#include "coordinator/store/data_dir.h"
#include "coordinator/store/file_spool.h"
#include "renderer/util/result.h"

namespace tessera {

struct RecoveryOptions {
  int attempts_max = kAttemptsMaxDefault;
  uint64_t keep_sums_bytes = kKeptBytesMaxDefault;
};

struct RecoveredFarm {
  std::unique_ptr<Farm> farm;
  std::unique_ptr<Journal> journal;
  std::unique_ptr<Spool> spool;
  std::vector<std::string> log;  // "event key=value ..."
};

// Farm, journal and spool of a data directory, old or new. An error that names the file if one is damaged.
// `run` runs the background tasks of the spool.
Result<RecoveredFarm> Recover(const DataDir& directory, const RecoveryOptions& options, FileSpool::Run run);

}  // namespace tessera
