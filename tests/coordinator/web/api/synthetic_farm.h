// A farm of any size that renders nothing, for tests and measurements of the web interface.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include "coordinator/web/api/web_farm.h"

namespace tessera {

inline FarmView SyntheticView(size_t jobs, size_t workers, uint64_t moment = 0) {
  constexpr JobState kStates[] = {JobState::kFinished, JobState::kRunning, JobState::kWaiting,
                                  JobState::kPaused,   JobState::kFailed,  JobState::kCancelled};
  FarmView view;
  for (size_t i = 0; i < jobs; ++i) {
    JobStatus job;
    job.job = JobId{i + 1};
    job.name = fmt::format("shot {:03} layer {}", i / 7, i % 7);
    job.owner.name = i % 3 == 0 ? "ada" : "bob";
    job.owner.member = MemberId{1 + i % 3};
    job.state = i % 10 < 5 ? kStates[i % 6] : JobState::kFinished;
    job.reason = job.state == JobState::kFailed ? "scene.pbrt:12:3: unknown material" : "";
    job.priority = static_cast<int32_t>(i % 5);
    job.samples_total = 1'000'000;
    job.samples_done =
        HasEnded(job.state) ? job.samples_total : (i * 7919 + moment * 1000) % job.samples_total;
    job.samples_per_second = job.state == JobState::kRunning ? 12'345.0 : 0;
    job.elapsed = std::chrono::seconds(i % 4000);
    job.left =
        job.state == JobState::kRunning ? std::chrono::seconds(60 + i % 900) : std::chrono::seconds(-1);
    job.frames_total = 1 + i % 3;
    view.jobs.push_back(job);
    if (!HasEnded(job.state)) view.samples_left += job.samples_total - job.samples_done;
  }
  for (size_t i = 0; i < workers; ++i) {
    WorkerStatus worker;
    worker.worker = WorkerId{i + 1};
    worker.name = fmt::format("blade-{:04}", i);
    worker.slots = 16;
    worker.software_version = kSoftwareVersion;
    worker.leases = i % 9 == 0 ? 0 : 32;
    worker.units_finished = 100 * i;
    worker.units_failed = i % 97 == 0 ? 3 : 0;
    worker.quarantined = i % 251 == 250;
    if (worker.quarantined) worker.reason = "3 results differ from those of other workers";
    worker.utilisation = static_cast<double>((i * 37 + moment) % 100) / 100;
    worker.samples_per_second = 50'000 * worker.utilisation;
    worker.tags = {i % 2 == 0 ? "gpu" : "big"};
    view.workers.push_back(worker);
  }
  view.slots = {static_cast<int>(workers) * 14, 0, 0, static_cast<int>(workers) * 2};
  view.disk_free = 400'000'000'000;
  view.disk_total = 1'000'000'000'000;
  return view;
}

// Everybody may do everything; changes change nothing.
inline WebFarm SyntheticFarm(size_t jobs, size_t workers) {
  WebFarm farm;
  farm.admit = [](const auto&, auto) { return std::nullopt; };
  farm.reach = [](const auto&, auto) { return WebReach::kEverything; };
  farm.view = [=, moment = std::make_shared<std::atomic<uint64_t>>(0)] {
    return std::optional(SyntheticView(jobs, workers, ++*moment));
  };
  const auto find = [=](JobId job) -> WebResult<JobStatus> {
    if (Number(job) == 0 || Number(job) > jobs) return WebError{404, "there is no such job"};
    return SyntheticView(Number(job), 0).jobs.back();
  };
  farm.admit_to_job = [find](const auto&, auto, JobId job, auto done) { done(find(job)); };
  farm.detail = [find](JobId job, uint32_t, auto done) {
    const auto found = find(job);
    if (const auto* const error = std::get_if<WebError>(&found)) return done(*error);
    done(JobDetail{std::get<JobStatus>(found), nullptr, {{0, {}}}, {}});
  };
  farm.change_job = [find](const auto&, const JobChange& change, auto done) { done(find(change.job)); };
  farm.change_workers = [=](const auto&, auto, const auto&, auto done) {
    done(SyntheticView(0, workers).workers);
  };
  farm.frame = [](JobId, uint32_t) { return WebError{404, "there is no such frame"}; };
  farm.log = [find](JobId job, uint64_t after, size_t limit) -> WebResult<JobLogPage> {
    const auto found = find(job);
    if (const auto* const error = std::get_if<WebError>(&found)) return *error;
    JobLogPage page;
    for (uint64_t number = std::min<uint64_t>(after, 3) + 1; number <= 3 && page.entries.size() < limit;
         ++number)
      page.entries.push_back({number, 1'700'000'000'000, MessageLevel::kWarning, "worker blade-1 is gone"});
    return page;
  };
  farm.read = [](JobId, uint32_t, const auto&) { return WebError{404, "there is no such frame"}; };
  farm.open = [](JobId, uint32_t, const auto&) { return WebError{404, "there is no such frame"}; };
  farm.keep = [](std::string_view bytes) { return ReadableFile::Nameless("/tmp", bytes); };
  farm.order_job = [](const auto&, const auto&, auto done) { done(WebError{503, "nothing is rendered"}); };
  farm.find_missing = [](const auto&, auto done) { done(std::map<Digest, uint64_t>()); };
  farm.run_later = [](auto task) { task(); };
  return farm;
}

}  // namespace tessera
