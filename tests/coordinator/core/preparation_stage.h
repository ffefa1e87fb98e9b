// A farm with jobs that workers prepare, the workers' calls, and what they report.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/core/preparations.h"
#include "tests/coordinator/core/farm_stage.h"

namespace tessera {

using std::chrono::milliseconds;
using std::chrono::seconds;

inline const JobOwner kOwnerAda{MemberId{1}, "ada"}, kOwnerBob{MemberId{2}, "bob"};

inline std::shared_ptr<JobOrder> SmallOrder(uint64_t submission, int frames = 1) {
  auto order = std::make_shared<JobOrder>();
  order->submission = submission;
  order->name = "small";
  order->scene.package = Sha256("package");
  order->scene.scene_file = "s#";
  order->scene.options = "spp=4\n";
  order->scene.frames = FrameRange{0, frames - 1, 1};
  return order;
}

inline PreparationReport Prepared(const JobOrder& order, int frames = 1) {
  PreparationReport report;
  report.key = PreparationKey(order);
  report.frames = SmallJob(1, frames)->frames;
  for (FrameRequest& frame : report.frames)
    frame.options = "fps=24\nframe=7\nspp=4\ntime=0.5\ntime-step=0.1\n";
  return report;
}

inline PreparationReport NotPrepared(const JobOrder& order, const std::string& reason) {
  PreparationReport report;
  report.key = PreparationKey(order);
  report.reason = reason;
  return report;
}

struct PreparationStage : FarmStage {
  // The request in the answer to the state of a worker, which lists `held`. A call that waits is answered
  // when there is news.
  std::optional<PreparationRequest> Call(uint64_t worker, std::vector<Digest> held = {},
                                         Instant after = milliseconds(260)) {
    now += after;
    WorkerState state = Worker(worker);
    state.name = "w" + std::to_string(worker);
    state.farm = farm.id();
    state.preparations = std::move(held);
    state.member = members[worker];
    const CallId call{++calls};
    farm.Synchronize(now, call, state);
    Step();
    for (const auto& each : output.directives) {
      if (each.call == call) return each.directive.preparation;
    }
    return std::nullopt;
  }
  std::map<uint64_t, MemberId> members;  // of workers; 0: none
  void Wait(Instant duration) {
    for (const Instant end = now + duration; now < end;) {
      now += milliseconds(250);
      Step();
    }
  }
  // Contacts of workers, so that none falls silent.
  void Pass(Instant duration, const std::vector<uint64_t>& workers, const std::vector<Digest>& held = {}) {
    for (const Instant end = now + duration; now < end;) {
      now += seconds(1);
      for (const uint64_t worker : workers) (void)Call(worker, held);
    }
  }
  void Return(uint64_t worker, const PreparationReport& report) {
    farm.ReturnPreparation(now, WorkerId{worker}, report);
    Step();
  }
  JobId Order(const std::shared_ptr<JobOrder>& order, const JobOwner& owner = kOwnerAda) {
    const auto job = farm.Order(now, order, owner);
    EXPECT_TRUE(job) << job.error().message;
    Step();
    return *job;
  }
};

}  // namespace tessera
