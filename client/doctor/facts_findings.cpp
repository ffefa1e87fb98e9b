#include "client/doctor/facts_findings.h"

#include <fmt/format.h>

#include <cmath>

namespace tessera {
namespace {

// Certificates are valid from an hour before they were issued. Long before that, times in logs mislead.
constexpr double kClockProblem_s = 1800, kClockWarning_s = 10;

Finding CheckClockOf(const std::string& where, const CoordinatorFacts& facts) {
  const double ahead = facts.clock_ahead_s;
  const double uncertain = facts.answer_s / 2;
  const std::string what = fmt::format("the coordinator's clock is {:.1f} s {} that of this machine",
                                       std::abs(ahead), ahead > 0 ? "ahead of" : "behind");
  if (std::abs(ahead) - uncertain > kClockProblem_s)
    return {Severity::kProblem, where, what,
            "correct the clock that is wrong (timedatectl set-ntp true): certificates depend on it"};
  if (std::abs(ahead) - uncertain > kClockWarning_s)
    return {Severity::kWarning, where, what, "synchronise the clocks (timedatectl set-ntp true)"};
  return {Severity::kGood, where, "the clocks of this machine and the coordinator agree", {}};
}

Finding CheckVersion(const std::string& where, const CoordinatorFacts& facts) {
  const std::string what =
      fmt::format("the coordinator has version {} (protocol {}), this program {} (protocol {})",
                  facts.software_version, facts.protocol, kSoftwareVersion, kProtocolVersion);
  if (facts.software_version == kSoftwareVersion && facts.protocol == kProtocolVersion)
    return {Severity::kGood,
            where,
            fmt::format("the coordinator answers, with version {}", kSoftwareVersion),
            {}};
  return {Severity::kProblem, where, what, "install the same version on all machines of the farm"};
}

Findings CheckWorkers(const std::string& where, const std::vector<WorkerStatus>& workers) {
  Findings findings;
  for (const WorkerStatus& each : workers) {
    if (each.software_version != kSoftwareVersion) {
      findings.push_back({Severity::kProblem, where,
                          fmt::format("worker {} has version {}", each.name, each.software_version),
                          "install the same version on all machines of the farm"});
    }
    if (each.quarantined) {
      findings.push_back({Severity::kWarning, where,
                          fmt::format("worker {} is quarantined: {}", each.name, each.reason),
                          fmt::format("examine that machine, then run: tessera release {}", each.name)});
    }
  }
  if (findings.empty() && !workers.empty()) {
    findings.push_back(
        {Severity::kGood,
         where,
         Counted(workers.size(), "worker") + " connected, of this version and none quarantined",
         {}});
  }
  return findings;
}

}  // namespace

Findings FindingsOf(const std::string& where, const CoordinatorFacts& facts) {
  Findings findings{CheckVersion(where, facts)};
  if (facts.has_clock) findings.push_back(CheckClockOf(where, facts));
  if (facts.workers) Append(findings, CheckWorkers(where, *facts.workers));
  return findings;
}

}  // namespace tessera
