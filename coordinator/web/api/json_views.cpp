#include "coordinator/web/api/json_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>

#include "coordinator/web/api/picture_layers.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

using nlohmann::json;

constexpr uint64_t kPageMax = 1000;
constexpr uint64_t kPageDefault = 100;
// With the history of each, some 5 KB.
constexpr uint64_t kHistoryPageMax = 200;

double SecondsOf(std::chrono::milliseconds duration) {
  return static_cast<double>(duration.count()) / 1000;
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

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

json TimesJson(const JobTimes& times) {
  return {{"render_s", times.render_s}, {"waste_s", times.waste_s},     {"other_s", times.other_s},
          {"fetch_s", times.fetch_s},   {"load_s", times.load_s},       {"idle_s", times.idle_s},
          {"tail_s", times.tail_s},     {"writing_s", times.writing_s}, {"overhead_s", times.overhead_s},
          {"merge_s", times.merge_s},   {"journal_s", times.journal_s}, {"picture_s", times.picture_s}};
}

WebError Wrong(const char* parameter, const std::string& expected) {
  return {400, fmt::format("{}: expected {}", parameter, expected)};
}

std::string ValueOf(const Query& query, const char* name) {
  const auto found = query.find(name);
  return found != query.end() ? found->second : "";
}

// What a list is sorted by: numbers first, then text.
struct SortKey {
  double number = 0;
  std::string text;
  auto operator<=>(const SortKey&) const = default;
};

template <typename Element>
struct ListRules {
  std::map<std::string, std::function<SortKey(const Element&)>> keys;
  std::string key_default;
  std::function<bool(const Element&)> is_selected;
  std::function<json(const Element&)> show;
  const char* name;
};

// A page of the elements that are selected.
template <typename Element>
WebResult<json> ListJson(const std::vector<Element>& all, const Query& query, uint64_t page_max,
                         const ListRules<Element>& rules) {
  uint64_t offset = 0, limit = std::min(kPageDefault, page_max);
  if (!ReadNumber(query, "offset", UINT32_MAX, offset)) return Wrong("offset", "a number");
  if (!ReadNumber(query, "limit", page_max, limit))
    return Wrong("limit", fmt::format("a number up to {}", page_max));
  const std::string order = ValueOf(query, "order");
  if (!order.empty() && order != "asc" && order != "desc") return Wrong("order", "asc or desc");
  std::string sort = ValueOf(query, "sort");
  if (sort.empty()) sort = rules.key_default;
  const auto key = rules.keys.find(sort);
  if (key == rules.keys.end()) return Wrong("sort", "the name of a column");
  std::vector<std::pair<SortKey, const Element*>> selected;
  for (const Element& each : all) {
    if (rules.is_selected(each)) selected.emplace_back(key->second(each), &each);
  }
  std::ranges::stable_sort(selected, {}, [](const auto& each) -> const SortKey& { return each.first; });
  if (order == "desc") std::ranges::reverse(selected);
  json page = json::array();
  for (size_t i = offset; i < selected.size() && i - offset < limit; ++i)
    page.push_back(rules.show(*selected[i].second));
  return json{{"total", selected.size()}, {"offset", offset}, {rules.name, std::move(page)}};
}

bool Contains(const std::string& text, const std::string& lower_part) {
  return lower_part.empty() || Lower(text).find(lower_part) != std::string::npos;
}

ListRules<JobStatus> JobRules(const Query& query) {
  using Job = JobStatus;
  ListRules<Job> rules;
  rules.name = "jobs";
  rules.key_default = "id";
  rules.show = [](const Job& job) { return JobJson(job); };
  rules.is_selected = [search = Lower(ValueOf(query, "search")), state = ValueOf(query, "state"),
                       owner = ValueOf(query, "owner")](const Job& job) {
    if (state == "open" ? HasEnded(job.state) : !state.empty() && state != JobStateName(job.state))
      return false;
    if (!owner.empty() && owner != job.owner.name) return false;
    return Contains(job.name, search) || Contains(job.owner.name, search) ||
           fmt::format("{}", Number(job.job)) == search;
  };
  rules.keys = {
      {"id",
       [](const Job& job) {
         return SortKey{static_cast<double>(Number(job.job)), ""};
       }},
      {"name",
       [](const Job& job) {
         return SortKey{0, Lower(job.name)};
       }},
      {"owner",
       [](const Job& job) {
         return SortKey{0, Lower(job.owner.name)};
       }},
      {"state",
       [](const Job& job) {
         return SortKey{static_cast<double>(job.state), ""};
       }},
      {"priority",
       [](const Job& job) {
         return SortKey{static_cast<double>(job.priority), ""};
       }},
      {"progress",
       [](const Job& job) {
         return SortKey{ProgressOf(job), ""};
       }},
      {"rate",
       [](const Job& job) {
         return SortKey{job.samples_per_second, ""};
       }},
      {"noise",
       [](const Job& job) {
         return SortKey{job.noise.value_or(-1), ""};
       }},
      {"left",
       [](const Job& job) {
         return SortKey{SecondsOf(job.left), ""};
       }},
      {"elapsed",
       [](const Job& job) {
         return SortKey{SecondsOf(job.elapsed), ""};
       }},
  };
  return rules;
}

ListRules<WorkerStatus> WorkerRules(const Query& query, const FarmWatch* history) {
  using Worker = WorkerStatus;
  ListRules<Worker> rules;
  rules.name = "workers";
  rules.key_default = "name";
  rules.show = [history](const Worker& worker) {
    json shown = WorkerJson(worker);
    if (history == nullptr) return shown;
    json points = json::array();
    for (const auto& [rate, use] : history->HistoryOf(worker.worker)) points.push_back({rate, use});
    shown["history"] = std::move(points);
    return shown;
  };
  rules.is_selected = [search = Lower(ValueOf(query, "search")),
                       state = ValueOf(query, "state")](const Worker& worker) {
    if (!state.empty() && state != StateOf(worker)) return false;
    if (worker.tags.contains(search)) return true;
    return Contains(worker.name, search) || fmt::format("{:016x}", Number(worker.worker)) == search;
  };
  rules.keys = {
      {"name",
       [](const Worker& worker) {
         return SortKey{0, Lower(worker.name)};
       }},
      {"state",
       [](const Worker& worker) {
         return SortKey{0, StateOf(worker)};
       }},
      {"rate",
       [](const Worker& worker) {
         return SortKey{worker.samples_per_second, ""};
       }},
      {"use",
       [](const Worker& worker) {
         return SortKey{worker.utilisation, ""};
       }},
      {"speed",
       [](const Worker& worker) {
         return SortKey{worker.speed, ""};
       }},
      {"memory",
       [](const Worker& worker) {
         return SortKey{static_cast<double>(worker.memory_bytes), ""};
       }},
      {"failed",
       [](const Worker& worker) {
         return SortKey{static_cast<double>(worker.units_failed), ""};
       }},
      {"silent",
       [](const Worker& worker) {
         return SortKey{SecondsOf(worker.silent), ""};
       }},
  };
  return rules;
}

}  // namespace

std::string JsonText(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

bool ReadNumber(const Query& query, const char* name, uint64_t max, uint64_t& number) {
  const auto found = query.find(name);
  if (found == query.end()) return true;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number <= max;
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
             {"elapsed_s", SecondsOf(job.elapsed)},
             {"left_s", nullptr},
             {"noise", nullptr},
             {"frames_total", job.frames_total},
             {"frames_finished", job.frames_finished},
             {"frames_failed", job.frames_failed}};
  if (job.noise) shown["noise"] = *job.noise;
  if (job.left.count() >= 0 && !HasEnded(job.state)) shown["left_s"] = SecondsOf(job.left);
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
          {"silent_s", SecondsOf(worker.silent)},
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

WebResult<json> JobsJson(const FarmView& view, const Query& query) {
  return ListJson(view.jobs, query, kPageMax, JobRules(query));
}

WebResult<json> WorkersJson(const FarmWatch& watch, const FarmView& view, const Query& query) {
  const bool has_history = query.contains("history");
  return ListJson(view.workers, query, has_history ? kHistoryPageMax : kPageMax,
                  WorkerRules(query, has_history ? &watch : nullptr));
}

}  // namespace tessera
