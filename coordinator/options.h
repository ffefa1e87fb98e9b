// What tessera-coordinator is told on its command line. Parsed once, checked once, logged once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "coordinator/store/blob_store.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

struct CoordinatorOptions {
  std::vector<Address> listen;
  std::optional<Address> http;  // of the status page and the metrics
  std::string data_dir;
  uint64_t blob_bytes = kBlobBytesDefault;  // of scene files kept at most
  bool insecure = false;          // listen where other machines can reach it, though nobody has to log in
  bool exit_with_parent = false;  // end when the process that started this one ends
  int attempts_max = 3;           // different workers that may fail a unit before its job fails
  uint64_t keep_sums_bytes = kKeptBytesMaxDefault;  // of finished frames, so that they can be extended
  std::string log_level = "info";

  std::string Text() const;  // for the log
};

// An error (kBadInput) for bad usage. Prints help or version itself when asked for; then there are no options
// and no error either.
Result<std::optional<CoordinatorOptions>> ParseCoordinatorOptions(int argc, char** argv);

}  // namespace tessera
