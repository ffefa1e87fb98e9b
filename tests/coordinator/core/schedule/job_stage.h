// Jobs for tests of single parts of the scheduler.
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "coordinator/core/schedule/job.h"

namespace tessera {

// Frames of 32 x 32 pixels in 4 tiles, each of a scene of its own.
class JobStage {
 public:
  Job& Make(uint64_t id, uint32_t samples, int priority = 0, int frames = 1) {
    auto spec = std::make_shared<JobSpec>();
    spec->submission = id;
    spec->priority = priority;
    spec->package = Sha256(std::to_string(id));
    for (int f = 0; f < frames; ++f) {
      FrameSpec frame;
      frame.width = frame.height = 32;
      frame.crop = {0, 0, 32, 32};
      frame.tile_size = 16;
      frame.samples_per_pixel = samples;
      spec->frames.push_back({"scene" + std::to_string(f), "", frame, f});
    }
    Job& job = jobs_.emplace_back();
    job.id = JobId{id};
    job.priority = priority;
    job.submitted = job.spec = spec;
    job.schedule.has_one_scene = frames == 1;
    for (int f = 0; f < frames; ++f) job.schedule.ahead.insert(static_cast<uint32_t>(f));
    return job;
  }

 private:
  std::deque<Job> jobs_;
};

}  // namespace tessera
