// Everything that the command line of `tessera-worker` can say.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

constexpr uint64_t kCacheBytesDefault = uint64_t{20}
                                        << 30;  // some large scenes: fetched once per machine, not per job
constexpr const char* kLogLevelDefault = "info";
constexpr uint64_t kCacheBytesMin = uint64_t{1} << 20;

// Parsed and checked once, constant ever after.
struct WorkerOptions {
  Address coordinator;
  int threads = 0;        // render threads, each a slot; default: the processors that may be used
  std::string cache_dir;  // of scene files; default: $XDG_CACHE_HOME/tessera or ~/.cache/tessera
  uint64_t cache_bytes = kCacheBytesDefault;
  std::string name;            // for people; default: the host's
  std::set<std::string> tags;  // what it has that not every worker has
  std::string log_level = kLogLevelDefault;
};

struct WorkerCommandLine {
  WorkerOptions options;
  std::string answer;  // not empty: print this (help, version) and be done
};

// `arguments` without the program's name.
Result<WorkerCommandLine> ParseWorkerCommandLine(const std::vector<std::string>& arguments);

}  // namespace tessera
