#include "coordinator/read_farm_view.h"

#include "coordinator/ask_core.h"

namespace tessera {

std::optional<FarmView> ReadFarmView(CoreThread& core) {
  return AskCore(core, [](CoreContext& context) {
    const Farm& farm = context.farm;
    FarmView view;
    view.jobs = farm.Jobs(context.now);
    view.workers = farm.Workers(context.now);
    view.counters = farm.counters();
    view.slots = farm.scheduler().slot_use();
    view.storage_reason = farm.storage_reason();
    view.leases = farm.scheduler().lease_count();
    for (const JobStatus& job : view.jobs) {
      if (!HasEnded(job.state)) view.samples_left += job.samples_total - job.samples_done;
    }
    return view;
  });
}

}  // namespace tessera
