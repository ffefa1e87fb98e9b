#include "client/doctor/machine_checks.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/timex.h>

#include "proto/probe.h"
#include "proto/shell/program.h"
#include "proto/terms.h"
#include "renderer/scene/probe.h"
#include "renderer/util/cores.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

// What a coordinator of some hundred workers needs.
constexpr rlim_t kDescriptorsForFarm = 1024;
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

Finding CheckProbe(const std::string& where, const Result<Digest>& rendered) {
  if (!rendered)
    return {Severity::kProblem, where, "this machine cannot render: " + rendered.error().message,
            "install the release again"};
  if (rendered->Hex() == kProbeDigest)
    return {Severity::kGood, where, "renders the same bits as all machines of this release", {}};
  return {Severity::kProblem, where,
          fmt::format("renders other bits than this release: the probe unit has the digest {}, expected {}; "
                      "no coordinator accepts a worker of this machine",
                      rendered->Hex(), kProbeDigest),
          "install the release that was built for this system; if it is, its processor or a library "
          "(libembree, glibc) computes something else"};
}

Findings CheckMachine() {
  const std::string where = fmt::format("this machine, Tessera {}", kSoftwareVersion);
  return {CheckThreadsHere(where), CheckDescriptors(where), CheckClock(where),
          CheckProbe(where, RenderProbe())};
}

}  // namespace tessera
