// I5: once faults stop every job ends, and as it should.
#include <fmt/format.h>

#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class EndChecker : public Checker {
 public:
  using Checker::Checker;
  void OnEnd(const Farm* farm, Instant now) override {
    for (const JobModel& job : world_.jobs) {
      if (job.directory != world_.directory) {
        JobStatus last;
        last.state = job.told;
        Check(job, last);
        continue;
      }
      const auto status = farm != nullptr ? farm->Status(now, job.id) : std::nullopt;
      if (status) {
        Check(job, *status);
      } else {
        world_.Violation("a job is forgotten at the end: " + job.spec->name);
      }
    }
  }

 private:
  void Check(const JobModel& job, const JobStatus& status) {
    const SimulationOptions& options = world_.options;
    // Two different wrong results and the right one are three votes of which no two agree.
    // A unit with which three workers died one by one cannot be told from one that kills them.
    const bool may_be_taken_for_killer =
        world_.deaths >= 3 && (status.reason.find("kills its workers") != std::string::npos ||
                               status.reason.find("was lost while") != std::string::npos);
    const bool may_fail = job.is_killer || may_be_taken_for_killer || job.is_poisoned ||
                          options.one_fails_units || options.one_damages_results || options.one_lies;
    const std::string what =
        fmt::format("{} is {} with {} of {} samples ({})", job.spec->name, JobStateName(status.state),
                    status.samples_done, status.samples_total, status.reason);
    const bool is_finished = status.state == JobState::kFinished;
    if (!HasEnded(status.state)) world_.Violation("not ended: " + what);
    if (job.is_killer && is_finished) world_.Violation("a job that kills its workers finished: " + what);
    if (job.is_poisoned && is_finished) world_.Violation("a poisoned job finished: " + what);
    if (status.state == JobState::kFailed && !may_fail) world_.Violation("failed without cause: " + what);
    if (status.state == JobState::kCancelled && !job.is_cancelled)
      world_.Violation("cancelled though nobody asked for it: " + what);
    if (is_finished && status.samples_done != status.samples_total)
      world_.Violation("finished early: " + what);
  }
};

}  // namespace

std::unique_ptr<Checker> MakeEndChecker(World& world) {
  return std::make_unique<EndChecker>(world);
}

}  // namespace tessera
