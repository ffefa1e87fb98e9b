#include "client/doctor/machine_checks.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/timex.h>

#include "proto/terms.h"
#include "renderer/util/cores.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// What programs need for some connections and scene files, and what a coordinator of some hundred workers
// needs.
constexpr rlim_t kDescriptorsMin = 64, kDescriptorsForFarm = 1024;
// Of a worker or coordinator besides one for each processor: gRPC's and their own.
constexpr int kThreads = 40;

Finding CheckDescriptors(const std::string& where) {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  const std::string what = fmt::format("a process may open {} files", limit.rlim_max);
  if (limit.rlim_max < kDescriptorsMin)
    return {Severity::kProblem, where, what,
            fmt::format("raise the hard limit (ulimit -Hn) to {} or more", kDescriptorsMin)};
  if (limit.rlim_max < kDescriptorsForFarm) {
    return {Severity::kWarning, where, what,
            "a coordinator here can have a few hundred workers at most: raise the hard limit (ulimit -Hn)"};
  }
  return {Severity::kGood, where, what, {}};
}

Finding CheckThreadsHere(const std::string& where) {
  if (const auto can_start = CheckThreads(kThreads + UsableCores()); !can_start)
    return {Severity::kProblem, where, can_start.error().message,
            "raise the limit (ulimit -u, TasksMax of the service, pids of the container)"};
  return {Severity::kGood, where, fmt::format("{} processors, and threads enough", UsableCores()), {}};
}

Finding CheckClock(const std::string& where) {
  timex clock{};
  const bool is_synchronised = ::adjtimex(&clock) >= 0 && (clock.status & STA_UNSYNC) == 0;
  if (is_synchronised) return {Severity::kGood, where, "the clock is synchronised", {}};
  return {Severity::kWarning, where,
          "nothing synchronises the clock of this machine: certificates are refused when it is wrong by more "
          "than an hour",
          "run: timedatectl set-ntp true"};
}

}  // namespace

Findings CheckMachine() {
  const std::string where = fmt::format("this machine, Tessera {}", kSoftwareVersion);
  return {CheckThreadsHere(where), CheckDescriptors(where), CheckClock(where)};
}

}  // namespace tessera
