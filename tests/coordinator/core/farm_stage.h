// A stage for farm tests: a farm of small jobs, a clock, and what came out.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/core/farm.h"
#include "tests/coordinator/core/former_lease.h"

namespace tessera {

// Frames of one tile of 8 x 8 pixels and 4 samples.
inline std::shared_ptr<JobSpec> SmallJob(uint64_t submission, int frames = 1) {
  auto spec = std::make_shared<JobSpec>();
  spec->submission = submission;
  spec->name = "small";
  FrameSpec frame;
  frame.width = frame.height = 8;
  frame.crop = {0, 0, 8, 8};
  frame.tile_size = 8;
  frame.samples_per_pixel = 4;
  frame.channels = ColorsAndWeight({"R"});
  for (int f = 0; f < frames; ++f) spec->frames.push_back({"s" + std::to_string(f), "", frame, f});
  return spec;
}

// All sums are those of ones, and so are counts of samples.
inline RadianceTile Ones(SampleRange range, uint32_t channels = 2) {
  RadianceTile tile{{0, 0, 8, 8}, range, {channels}, {}};
  tile.sums.assign(static_cast<size_t>(64 * channels), static_cast<float>(range.size));
  return tile;
}

struct FarmStage {
  FarmStage() { farm.Begin(now); }
  void Step() {
    farm.Advance(now);
    output = farm.TakeOutput();
    for (const Fact& fact : output.facts) facts.push_back(EncodeFact(fact));
  }
  Verdict Return(JobId job, SampleRange range, Result<RadianceTile> tile, uint32_t frame = 0,
                 uint32_t tile_index = 0, uint64_t worker = 1) {
    const WorkUnit unit = Unit(job, frame, tile_index, range);
    JoinWithFormerLease(farm, now, CallId{++calls}, WorkerId{worker}, unit);
    farm.ReturnResults(now, CallId{++calls}, WorkerId{worker}, {{FormerLease(), unit, 0.1, tile}});
    Step();
    reason = output.results[0].reasons.empty() ? "" : output.results[0].reasons[0];
    return output.results[0].verdicts[0];
  }
  WorkUnit Unit(JobId job, uint32_t frame, uint32_t tile_index, SampleRange range) const {
    return {job, frame, tile_index, range, farm.SceneOf({job, frame}).value_or(Digest{})};
  }
  JobStatus Status(JobId job) const { return *farm.Status(now, job); }
  WorkerState Worker(uint64_t id) {
    WorkerState state;
    state.worker = WorkerId{id};
    state.sequence = ++calls;
    state.wait = std::chrono::seconds(2);
    return state;
  }

  Instant now = std::chrono::seconds(100);
  Farm farm{SchedulerOptions{kLaterEpoch}};
  FarmOutput output;
  std::vector<std::string> facts;
  std::string reason;
  uint64_t calls = 0;
};

}  // namespace tessera
