// The command line of `tessera-coordinator`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "proto/identity/tls_files.h"
#include "proto/roles.h"
#include "proto/shell/flags.h"
#include "proto/shell/log.h"
#include "proto/wire/address.h"
#include "renderer/util/result.h"

namespace tessera {

// A hundred large scenes or so; hardly a server has a smaller disk.
constexpr uint64_t kBlobBytesDefault = uint64_t{100} << 30;
constexpr uint64_t kBlobBytesMin = uint64_t{1} << 20;

// A join token to be printed at the start.
struct StartToken {
  Role role{};
  int uses = 1;
};

// Parsed, checked and logged once, constant from then on.
struct CoordinatorOptions {
  std::vector<Address> listen;
  // Of the web page and the metrics: plain, for this machine alone, and encrypted, for members.
  std::optional<Address> http, https;
  std::vector<std::string> http_names;  // under which browsers may ask for them
  std::string data_dir;
  // Names and addresses under which others reach the coordinator; default: those of this machine.
  std::vector<std::string> names;
  TlsFiles tls;  // certificates of an organisation, if used
  std::vector<StartToken> tokens;
  uint64_t blob_bytes = kBlobBytesDefault;  // limit of the scene files kept
  // Limit of the sums kept of finished frames, for tessera extend.
  uint64_t keep_sums_bytes = kKeptBytesMaxDefault;
  bool insecure = false;                   // TCP addresses, all of this machine alone, without TLS and login
  bool start_afresh = false;               // accept a data directory whose journal is gone
  bool exit_with_parent = false;           // end when the parent process ends
  int attempts_max = kAttemptsMaxDefault;  // workers that may fail a unit before its frame fails
  std::string log_level = kLogLevelDefault;

  std::string Text() const;  // for the log
};

// `arguments` without the program's name.
Result<CommandLineOf<CoordinatorOptions>> ParseCoordinatorCommandLine(
    const std::vector<std::string>& arguments);

}  // namespace tessera
