#include "coordinator/web/api/json_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coordinator/core/schedule/instant.h"
#include "coordinator/web/api/picture_layers.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

using nlohmann::json;

json TimesJson(const JobTimes& times) {
  return {{"render_s", times.render_s}, {"waste_s", times.waste_s},     {"other_s", times.other_s},
          {"fetch_s", times.fetch_s},   {"load_s", times.load_s},       {"idle_s", times.idle_s},
          {"tail_s", times.tail_s},     {"writing_s", times.writing_s}, {"overhead_s", times.overhead_s},
          {"merge_s", times.merge_s},   {"journal_s", times.journal_s}, {"picture_s", times.picture_s}};
}

}  // namespace

const char* StateOf(const WorkerStatus& worker) {
  if (worker.quarantined) return "quarantined";
  if (worker.draining) return "draining";
  if (worker.leases > 0) return "rendering";
  if (worker.fetching) return "fetching";
  return worker.loading ? "loading" : "idle";
}

double ProgressOf(const JobStatus& job) {
  return static_cast<double>(job.samples_done) /
         static_cast<double>(std::max<uint64_t>(job.samples_total, 1));
}

std::string JsonText(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

json JobJson(const JobStatus& job) {
  json shown{{"id", Number(job.job)},
             {"name", job.name},
             {"owner", job.owner.name},
             {"owner_member", job.owner.member != MemberId{} ? MemberIdText(job.owner.member) : ""},
             {"priority", job.priority},
             {"state", JobStateName(job.state)},
             {"reason", job.reason},
             {"paused_by_user", job.paused_by_user},
             {"samples_done", job.samples_done},
             {"samples_total", job.samples_total},
             {"progress", ProgressOf(job)},
             {"samples_per_second", job.samples_per_second},
             {"workers", job.workers},
             {"elapsed_s", Seconds(job.elapsed)},
             {"left_s", nullptr},
             {"noise", nullptr},
             {"frames_total", job.frames_total},
             {"frames_finished", job.frames_finished},
             {"frames_failed", job.frames_failed}};
  if (job.noise) shown["noise"] = *job.noise;
  if (job.left.count() >= 0 && !HasEnded(job.state)) shown["left_s"] = Seconds(job.left);
  return shown;
}

json DetailJson(const JobDetail& detail, const FarmView* view) {
  json shown = JobJson(detail.status);
  shown["times"] = TimesJson(detail.status.times);
  shown["verified"] = {{"share", detail.status.verify_share},
                       {"units", detail.status.units_verified},
                       {"disputed", detail.status.units_disputed},
                       {"suspect", detail.status.units_suspect}};
  json frames = json::array();
  for (const FrameStatus& frame : detail.frames) frames.push_back({frame.number, frame.file.has_value()});
  shown["frames"] = std::move(frames);
  std::map<WorkerId, std::string> names;
  if (view != nullptr && !detail.units.empty()) {
    for (const WorkerStatus& worker : view->workers) names[worker.worker] = worker.name;
  }
  json units = json::array();
  for (const LeasedUnit& unit : detail.units) {
    units.push_back({{"x0", unit.bounds.x0},
                     {"y0", unit.bounds.y0},
                     {"x1", unit.bounds.x1},
                     {"y1", unit.bounds.y1},
                     {"first_sample", unit.range.begin},
                     {"samples", unit.range.size},
                     {"worker", fmt::format("{:016x}", Number(unit.worker))},
                     {"worker_name", names[unit.worker]},
                     {"running", unit.has_started}});
  }
  shown["units"] = std::move(units);
  if (detail.spec != nullptr && !detail.spec->frames.empty()) {
    const FrameRequest& first = detail.spec->frames.front();
    shown["scene_file"] = first.scene_file;
    shown["width"] = first.spec.width;
    shown["height"] = first.spec.height;
    shown["samples_per_pixel"] = first.spec.samples_per_pixel;
    shown["noise_threshold"] = first.spec.noise_threshold;
    json layers = json::array();
    for (const PictureLayer& layer : LayersOf(first.spec))
      layers.push_back({{"name", layer.name}, {"channels", layer.channels}});
    shown["layers"] = std::move(layers);
    shown["can_extend"] = first.extendable && !first.spec.IsAdaptive();
  }
  return shown;
}

json JobLogJson(const JobLogPage& page) {
  json entries = json::array();
  for (const JobLogEntry& entry : page.entries) {
    entries.push_back({{"number", entry.number},
                       {"unix_time_ms", entry.unix_time_ms},
                       {"level", MessageLevelName(entry.level)},
                       {"text", entry.text}});
  }
  return {{"entries", std::move(entries)}, {"has_more", page.has_more}, {"has_ended", page.has_ended}};
}

json WorkerJson(const WorkerStatus& worker) {
  json scenes = json::array();
  for (const JobId job : worker.scenes) scenes.push_back(Number(job));
  return {{"id", fmt::format("{:016x}", Number(worker.worker))},
          {"name", worker.name},
          {"state", StateOf(worker)},
          {"reason", worker.reason},
          {"version", worker.software_version},
          {"tags", worker.tags},
          {"slots", worker.slots},
          {"leases", worker.leases},
          {"use", worker.utilisation},
          {"samples_per_second", worker.samples_per_second},
          {"speed", worker.speed},
          {"units_finished", worker.units_finished},
          {"units_failed", worker.units_failed},
          {"memory_bytes", worker.memory_bytes},
          {"scenes", std::move(scenes)},
          {"last_failure", worker.last_failure},
          {"silent_s", Seconds(worker.silent)},
          {"draining", worker.draining},
          {"quarantined", worker.quarantined}};
}

json FarmJson(const FarmMoment& moment) {
  const FarmView& view = moment.view;
  std::map<std::string, size_t> jobs, workers;
  double rate = 0;
  for (const JobStatus& job : view.jobs) {
    ++jobs[JobStateName(job.state)];
    rate += HasEnded(job.state) ? 0 : job.samples_per_second;
  }
  for (const WorkerStatus& worker : view.workers) ++workers[StateOf(worker)];
  const SlotUse& slots = view.slots;
  return {{"number", moment.number},
          {"jobs", jobs},
          {"jobs_total", view.jobs.size()},
          {"workers", workers},
          {"workers_total", view.workers.size()},
          {"slots",
           {{"leased", slots.leased},
            {"fetching", slots.fetching},
            {"loading", slots.loading},
            {"idle", slots.idle}}},
          {"leases", view.leases},
          {"samples_per_second", rate},
          {"samples_left", view.samples_left},
          {"bytes",
           {{"results_in", view.traffic.results_in},
            {"blobs_in", view.traffic.blobs_in},
            {"blobs_out", view.traffic.blobs_out},
            {"blobs_kept", view.blob_bytes},
            {"results_waiting", view.intake.bytes}}},
          {"disk", {{"free", view.disk_free}, {"total", view.disk_total}}},
          {"storage_reason", view.storage_reason}};
}

json HistoryJson(const std::vector<HistoryPoint>& history) {
  json points = json::array();
  for (const HistoryPoint& point : history) {
    points.push_back({{"time", point.unix_time_s},
                      {"samples_per_second", point.samples_per_second},
                      {"slots_leased", point.slots_leased},
                      {"slots", point.slots},
                      {"workers", point.workers},
                      {"jobs_open", point.jobs_open},
                      {"samples_left", point.samples_left},
                      {"blob_bytes", point.blob_bytes},
                      {"disk_free", point.disk_free},
                      {"units_failed", point.units_failed},
                      {"results_bytes", point.results_bytes}});
  }
  return {{"interval_s", kHistoryInterval.count()}, {"points", std::move(points)}};
}

}  // namespace tessera
