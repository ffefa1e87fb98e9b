#include "coordinator/job_changes.h"

#include <fmt/format.h>

#include <utility>

#include "coordinator/guarded.h"
#include "coordinator/picture_fetches.h"
#include "coordinator/submission.h"
#include "proto/wire/channel.h"

namespace tessera {

void JobChanges::Make(const UnaryCall& call, const JobChangeKind& change, JobId job, int64_t value,
                      const Answer& answer) const {
  std::string details = fmt::format("job={}", Number(job));
  if (!change.argument.empty()) details += fmt::format(" {}={}", change.argument, value);
  call.Note(std::move(details));
  if (value < change.min || value > change.max) {
    return call.Finish(
        ToStatus(BadInput(fmt::format("{}: expected {} to {}", change.argument, change.min, change.max))));
  }
  const auto make = [=, &change](CoreContext& core) {
    if (const grpc::Status may = call.AdmitToJob(core, job); !may.ok()) return may;
    if (change.needs_files && core.farm.IsMovingSums(job)) return PictureFetches::BeingWritten();
    return answer(change.make(core.farm, core.now, job, value));
  };
  if (!change.needs_files) return call.Apply(make);
  CheckFiles(call, job, [call, make] { call.Apply(make); });
}

// Checking takes too long for the core thread.
void JobChanges::CheckFiles(const UnaryCall& call, JobId job, const std::function<void()>& then) const {
  const auto check = [=, this](const JobSpec& spec) {
    const auto checked = GuardedResult([&] { return CheckSubmission(spec, blobs_); });
    if (checked) return then();
    const auto& [kind, reason] = checked.error();
    const bool is_late = kind == ErrorKind::kInterrupted;
    call.Finish(NotRenderable(is_late ? checked.error() : Failed(reason + "; submit the scene again")));
  };
  call.core().Post([=, this](CoreContext& core) {
    const grpc::Status posted = GuardedStatus([&] {
      if (const grpc::Status may = call.AdmitToJob(core, job); !may.ok()) return may;
      const auto spec = core.farm.Spec(job);
      PostCheck(files_, blobs_, spec->package, [check, spec] { check(*spec); });
      return grpc::Status::OK;
    });
    if (!posted.ok()) call.Finish(posted);
  });
}

}  // namespace tessera
