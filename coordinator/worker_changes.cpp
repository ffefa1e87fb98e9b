#include "coordinator/worker_changes.h"

#include <fmt/format.h>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

grpc::Status NoWorker(const std::string& which) {
  return {grpc::StatusCode::NOT_FOUND,
          fmt::format("there is no worker \"{}\"; run `tessera workers` to list them", which)};
}

}  // namespace

void ChangeWorkers(const UnaryCall& call, const WorkerChangeKind& change, const std::string& which,
                   const AnswerWorkerChange& answer) {
  call.Note(fmt::format("worker={}", LogText(which)));
  call.Apply([=, &change](CoreContext& core) {
    for (const WorkerStatus& worker : core.farm.FindWorkers(core.now, which))
      change.make(core.farm, worker.worker);
    const auto changed = core.farm.FindWorkers(core.now, which);
    if (changed.empty()) return NoWorker(which);
    answer(changed);
    return grpc::Status::OK;
  });
}

}  // namespace tessera
