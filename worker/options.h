// The command line of `tessera-worker`.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/identity/join_token.h"
#include "proto/identity/tls_files.h"
#include "proto/shell/flags.h"
#include "proto/shell/log.h"
#include "proto/wire/address.h"
#include "renderer/load/limited_load.h"
#include "renderer/util/result.h"

namespace tessera {

// Holds several large scenes: a file is fetched once per machine, not once per job.
constexpr uint64_t kCacheBytesDefault = uint64_t{20} << 30;
constexpr uint64_t kCacheBytesMin = uint64_t{1} << 20;

// Every scene that is worth a farm takes more.
constexpr std::chrono::hours kLoadTimeMax{24 * 7};

// Parsed and checked once, constant from then on.
struct WorkerOptions {
  TlsFiles tls;  // certificates of an organisation in place of a login
  // Without it: the coordinator of the token, or that of the last login.
  std::optional<Address> coordinator;
  std::optional<JoinToken> join;  // to become a member of its farm with
  std::string state_dir;          // of logins; default: WorkerLoginFolder
  bool insecure = false;          // plain text to an address of this machine
  int threads = 0;        // render threads, each of them a slot; default: the processors that may be used
  std::string cache_dir;  // of scene files; default: DefaultCacheFolder
  uint64_t cache_bytes = kCacheBytesDefault;
  std::string probe_dir;  // of a note that the probe was passed (probe_note.h); empty: none
  LoadLimits load_limits{0, kLoadTimeDefault};  // of one scene; default: DefaultSceneMemory
  std::string name;                             // shown to users; default: the host name
  std::set<std::string> tags;                   // that jobs may require
  std::string log_level = kLogLevelDefault;
};

// `arguments` without the program's name. A stop of the token ends the wait for a join token on standard
// input.
Result<CommandLineOf<WorkerOptions>> ParseWorkerCommandLine(const std::vector<std::string>& arguments,
                                                            const std::stop_token& termination = {});

}  // namespace tessera
