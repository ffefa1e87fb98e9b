#include "client/commands/status_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "client/commands/text_table.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

double Seconds(std::chrono::milliseconds duration) {
  return static_cast<double>(duration.count()) / 1000;
}

double Percent(const JobStatus& status) {
  if (status.samples_total == 0) return 0;
  return 100 * static_cast<double>(status.samples_done) / static_cast<double>(status.samples_total);
}

// Names come from other users: bytes that are not UTF-8 are replaced.
std::string Dump(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::ordered_json ToJson(const JobTimes& times) {
  nlohmann::ordered_json json;
  json["render_s"] = times.render_s;
  json["waste_s"] = times.waste_s;
  json["other_s"] = times.other_s;
  json["fetch_s"] = times.fetch_s;
  json["load_s"] = times.load_s;
  json["idle_s"] = times.idle_s;
  json["tail_s"] = times.tail_s;
  json["writing_s"] = times.writing_s;
  json["overhead_s"] = times.overhead_s;
  json["merge_s"] = times.merge_s;
  json["journal_s"] = times.journal_s;
  json["picture_s"] = times.picture_s;
  return json;
}

nlohmann::ordered_json ToJson(const JobStatus& status) {
  nlohmann::ordered_json json;
  json["job"] = Number(status.job);
  json["name"] = status.name;
  json["owner"] = status.owner.name;
  json["owner_member"] = nullptr;
  if (status.owner.member != MemberId{}) json["owner_member"] = MemberIdText(status.owner.member);
  json["priority"] = status.priority;
  json["state"] = JobStateName(status.state);
  json["reason"] = status.reason;
  json["paused_by_user"] = status.paused_by_user;
  json["samples_done"] = status.samples_done;
  json["samples_total"] = status.samples_total;
  json["samples_per_second"] = status.samples_per_second;
  json["workers"] = status.workers;
  json["elapsed_s"] = Seconds(status.elapsed);
  json["left_s"] = nullptr;
  if (status.left.count() >= 0) json["left_s"] = Seconds(status.left);
  json["frames_total"] = status.frames_total;
  json["frames_finished"] = status.frames_finished;
  json["frames_failed"] = status.frames_failed;
  json["noise"] = nullptr;
  if (status.noise) json["noise"] = *status.noise;
  json["times"] = ToJson(status.times);
  if (status.verify_share > 0) {
    json["verify_share"] = status.verify_share;
    json["units_verified"] = status.units_verified;
    json["units_disputed"] = status.units_disputed;
    json["units_suspect"] = status.units_suspect;
  }
  return json;
}

nlohmann::ordered_json ToJson(const WorkerStatus& status) {
  nlohmann::ordered_json json;
  // Too large for the numbers of some JSON readers.
  json["worker"] = fmt::format("{:016x}", Number(status.worker));
  json["name"] = status.name;
  json["slots"] = status.slots;
  json["software_version"] = status.software_version;
  json["leases"] = status.leases;
  json["units_finished"] = status.units_finished;
  json["units_failed"] = status.units_failed;
  json["speed"] = status.speed;
  json["silent_s"] = Seconds(status.silent);
  json["draining"] = status.draining;
  json["quarantined"] = status.quarantined;
  json["reason"] = status.reason;
  json["utilisation"] = status.utilisation;
  json["samples_per_second"] = status.samples_per_second;
  json["tags"] = status.tags;
  json["memory_bytes"] = status.memory_bytes;
  json["scenes"] = nlohmann::ordered_json::array();
  for (const JobId job : status.scenes) json["scenes"].push_back(Number(job));
  json["last_failure"] = status.last_failure;
  return json;
}

template <typename Status>
nlohmann::ordered_json ListOf(const std::vector<Status>& list) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Status& status : list) json.push_back(ToJson(status));
  return json;
}

std::string WorkerRemark(const WorkerStatus& status) {
  std::string remark;
  const auto add = [&](const std::string& text) { remark += (remark.empty() ? "" : "  ") + text; };
  if (!status.tags.empty()) add(fmt::format("[{}]", fmt::join(status.tags, " ")));
  if (status.quarantined) add("quarantined: " + status.reason);
  if (status.draining) add(status.leases > 0 ? "draining" : "drained");
  return remark;
}

// The outcome of verification; empty if the job is not verified.
std::string VerificationText(const JobStatus& status) {
  if (status.verify_share <= 0) return {};
  std::string text =
      fmt::format("{} units verified, {} disputed", status.units_verified, status.units_disputed);
  if (status.units_suspect > 0) {
    text += fmt::format(
        "; SUSPECT: the picture contains {} unverified units of a worker that returned wrong results",
        status.units_suspect);
  }
  return text;
}

}  // namespace

Progress ProgressOf(const JobStatus& status) {
  Progress progress;
  progress.samples_done = status.samples_done;
  progress.samples_total = status.samples_total;
  progress.samples_per_second = status.samples_per_second;
  progress.workers = static_cast<int>(status.workers);
  progress.elapsed_s = Seconds(status.elapsed);
  progress.left_s = status.left.count() >= 0 ? Seconds(status.left) : -1;
  progress.remark = status.reason;
  if (status.state == JobState::kPreparing)
    progress.remark =
        "a worker is to prepare the scene" + (status.reason.empty() ? "" : "; " + status.reason);
  if (status.frames_failed > 0 && !HasEnded(status.state)) {
    progress.remark += fmt::format("{}{} frame{} failed", progress.remark.empty() ? "" : "; ",
                                   status.frames_failed, status.frames_failed == 1 ? "" : "s");
  }
  progress.frames = {status.frames_finished, status.frames_total};
  progress.has_ended = HasEnded(status.state);
  if (const std::string text = VerificationText(status); !text.empty()) {
    progress.remark += (progress.remark.empty() ? "" : "; ") + text;
  }
  return progress;
}

std::string JobText(const JobStatus& status) {
  const std::string priority = status.priority == 0 ? "" : fmt::format(", priority {}", status.priority);
  const std::string owner = status.owner.name.empty() ? "" : ", owner " + status.owner.name;
  return fmt::format("job {} \"{}\"{}{}: {}  {}", Number(status.job), status.name, owner, priority,
                     JobStateName(status.state), ProgressText(ProgressOf(status), "worker"));
}

std::string JobTable(const std::vector<JobStatus>& jobs) {
  TextTable table({{"JOB", Align::kRight},
                   {"NAME", Align::kLeft},
                   {"OWNER", Align::kLeft},
                   {"PRIORITY", Align::kRight},
                   {"STATE", Align::kLeft},
                   {"DONE", Align::kRight},
                   {"FRAMES", Align::kRight},
                   {"SAMPLES/S", Align::kRight},
                   {"WORKERS", Align::kRight},
                   {"ELAPSED", Align::kRight}});
  for (const JobStatus& job : jobs) {
    table.Add({std::to_string(Number(job.job)), Shortened(job.name), Shortened(job.owner.name),
               std::to_string(job.priority), JobStateName(job.state), fmt::format("{:.1f} %", Percent(job)),
               fmt::format("{}/{}", job.frames_finished, job.frames_total),
               fmt::format("{:.0f}", job.samples_per_second), std::to_string(job.workers),
               DurationText(Seconds(job.elapsed))},
              job.reason);
  }
  return table.Text();
}

std::string WorkerTable(const std::vector<WorkerStatus>& workers) {
  TextTable table({{"WORKER", Align::kLeft},
                   {"NAME", Align::kLeft},
                   {"SLOTS", Align::kRight},
                   {"LEASES", Align::kRight},
                   {"FINISHED", Align::kRight},
                   {"FAILED", Align::kRight},
                   {"SPEED", Align::kRight},
                   {"BUSY", Align::kRight},
                   {"SAMPLES/S", Align::kRight},
                   {"SILENT", Align::kRight},
                   {"VERSION", Align::kLeft}});
  for (const WorkerStatus& worker : workers) {
    table.Add(
        {fmt::format("{:016x}", Number(worker.worker)), Shortened(worker.name), std::to_string(worker.slots),
         std::to_string(worker.leases), std::to_string(worker.units_finished),
         std::to_string(worker.units_failed), fmt::format("{:.2f}", worker.speed),
         fmt::format("{:.0f} %", 100 * worker.utilisation), fmt::format("{:.0f}", worker.samples_per_second),
         DurationText(Seconds(worker.silent)), worker.software_version},
        WorkerRemark(worker));
  }
  return table.Text();
}

std::string JobJson(const JobStatus& status) {
  return Dump(ToJson(status));
}
std::string JobsJson(const std::vector<JobStatus>& jobs) {
  return Dump(ListOf(jobs));
}
std::string WorkersJson(const std::vector<WorkerStatus>& workers) {
  return Dump(ListOf(workers));
}
std::string FarmJson(const FarmView& view) {
  nlohmann::ordered_json json;
  json["coordinator"] = view.address;
  json["jobs"] = ListOf(view.jobs);
  json["jobs_left_out"] = view.jobs_left_out;
  json["workers"] = ListOf(view.workers);
  json["workers_left_out"] = view.workers_left_out;
  return Dump(json);
}

}  // namespace tessera
