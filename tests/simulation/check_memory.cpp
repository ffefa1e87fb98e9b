// I4: a new process of the coordinator knows every job that a client knows of, and what it has come to.
#include <fmt/format.h>

#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class MemoryChecker : public Checker {
 public:
  using Checker::Checker;
  void OnRestart(const Farm& farm, Instant now) override {
    for (const JobModel& job : world_.jobs) {
      if (!job.is_acknowledged || job.directory != world_.directory) continue;
      const auto status = farm.Status(now, job.id);
      if (!status) {
        world_.Violation("a job is forgotten: " + job.spec->name);
      } else if (HasEnded(job.told) && status->state != job.told) {
        world_.Violation(fmt::format("{} was {} and is {}", job.spec->name, JobStateName(job.told),
                                     JobStateName(status->state)));
      }
    }
  }
};

}  // namespace

std::unique_ptr<Checker> MakeMemoryChecker(World& world) {
  return std::make_unique<MemoryChecker>(world);
}

}  // namespace tessera
