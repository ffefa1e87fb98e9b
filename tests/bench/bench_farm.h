// A coordinator process with a data directory of its own, for measuring programs.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "proto/roles.h"
#include "proto/wire/endpoint.h"
#include "tests/end_to_end/process.h"

namespace tessera {

// Of a process.
struct Usage {
  double megabytes = 0;  // that it holds in memory
  double cpu_s = 0;      // that it has used
  size_t descriptors = 0;
};
Usage UsageOf(pid_t pid);

// The size of the files in a folder.
double MegabytesIn(const std::string& folder);

// A temporary folder, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

enum class Security { kPlain, kTls };

// Throws std::runtime_error if a step fails.
class BenchFarm {
 public:
  explicit BenchFarm(Security security);
  const std::string& folder() const { return folder_.path(); }
  const std::string& address() const { return address_; }
  Process& coordinator() { return *coordinator_; }
  // For a new member with this role, who joins with a token; in plain text for anybody.
  Endpoint Join(Role role) const;
  // Runs `tessera` as the user of the coordinator.
  Outcome Tessera(std::vector<std::string> words) const;

 private:
  TemporaryFolder folder_;
  const Security security_;
  std::optional<Process> coordinator_;
  std::string address_;
};

}  // namespace tessera
