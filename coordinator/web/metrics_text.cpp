#include "coordinator/web/metrics_text.h"

#include <fmt/format.h>
#include <prometheus/text_serializer.h>

#include <map>

namespace tessera {
namespace {

// Larger farms are monitored as a whole: every series costs the monitoring system memory for weeks.
constexpr size_t kWorkersListedMax = 1000;

using Labels = std::vector<prometheus::ClientMetric::Label>;

class Families {
 public:
  void Counter(const char* name, const char* help, double value, Labels labels = {}) {
    Add(prometheus::MetricType::Counter, name, help, std::move(labels)).counter.value = value;
  }
  void Gauge(const char* name, const char* help, double value, Labels labels = {}) {
    Add(prometheus::MetricType::Gauge, name, help, std::move(labels)).gauge.value = value;
  }
  std::string Text() const { return prometheus::TextSerializer().Serialize(families_); }

 private:
  // Series of the same name are added one after the other.
  prometheus::ClientMetric& Add(prometheus::MetricType type, const char* name, const char* help,
                                Labels labels) {
    if (families_.empty() || families_.back().name != name) families_.push_back({name, help, type, {}});
    families_.back().metric.emplace_back().label = std::move(labels);
    return families_.back().metric.back();
  }
  std::vector<prometheus::MetricFamily> families_;
};

double D(uint64_t count) {
  return static_cast<double>(count);
}

void AddResults(const FarmCounters& c, Families& out) {
  const char* const name = "tessera_results_total";
  const char* const help = "Returned results by verdict.";
  out.Counter(name, help, D(c.units_accepted), {{"verdict", "accepted"}});
  out.Counter(name, help, D(c.units_duplicate), {{"verdict", "duplicate"}});
  out.Counter(name, help, D(c.units_obsolete), {{"verdict", "obsolete"}});
  out.Counter(name, help, D(c.units_refused), {{"verdict", "refused"}});
  out.Counter("tessera_units_failed_total", "Units that workers failed to render.", D(c.units_failed));
  out.Counter("tessera_samples_total", "Pixel samples merged into pictures; the rate is samples per second.",
              D(c.samples_accepted));
  out.Counter("tessera_samples_wasted_total", "Pixel samples of duplicate, obsolete and refused results.",
              D(c.samples_wasted));
}

void AddLeases(const FarmView& view, Families& out) {
  const FarmCounters& c = view.counters;
  out.Gauge("tessera_leases", "Units leased to workers.", D(view.leases));
  out.Counter("tessera_leases_granted_total", "Leases granted.", D(c.leases_granted));
  out.Counter("tessera_leases_expired_total", "Leases that were not renewed in time.", D(c.leases_expired));
  out.Counter("tessera_leases_retried_total",
              "Leases that ended without a result, so that their units were leased again.",
              D(c.leases_retried));
  out.Counter("tessera_leases_moot_total", "Leases withdrawn because another worker was faster.",
              D(c.leases_moot));
}

void AddSlots(const FarmView& view, Families& out) {
  const char* const now = "tessera_slots";
  const char* const now_help = "Render slots by current use.";
  out.Gauge(now, now_help, view.slots.leased, {{"use", "leased"}});
  out.Gauge(now, now_help, view.slots.fetching, {{"use", "fetching"}});
  out.Gauge(now, now_help, view.slots.loading, {{"use", "loading"}});
  out.Gauge(now, now_help, view.slots.idle, {{"use", "idle"}});
  const FarmCounters& c = view.counters;
  const char* const time = "tessera_slot_seconds_total";
  const char* const time_help = "Time of render slots by use.";
  out.Counter(time, time_help, c.leased_s, {{"use", "leased"}});
  out.Counter(time, time_help, c.fetching_s, {{"use", "fetching"}});
  out.Counter(time, time_help, c.loading_s, {{"use", "loading"}});
  out.Counter(time, time_help, c.idle_s, {{"use", "idle"}});
  out.Counter("tessera_render_seconds_total", "Time of slots spent on results that were accepted.",
              c.render_s);
  out.Counter("tessera_wasted_seconds_total", "Time of slots spent on duplicate and dropped units.",
              c.waste_s);
}

void AddWorkers(const FarmView& view, Families& out) {
  out.Gauge("tessera_workers", "Workers connected.", D(view.workers.size()));
  out.Counter("tessera_workers_lost_total", "Workers that left or were lost.", D(view.counters.workers_lost));
  if (view.workers.size() > kWorkersListedMax) return;
  const auto labels = [](const WorkerStatus& worker) {
    return Labels{{"worker", fmt::format("{:016x}", Number(worker.worker))}, {"name", worker.name}};
  };
  for (const WorkerStatus& worker : view.workers) {
    out.Gauge("tessera_worker_utilisation", "Share of the last minute that the slots of a worker rendered.",
              worker.utilisation, labels(worker));
  }
  for (const WorkerStatus& worker : view.workers) {
    out.Gauge("tessera_worker_samples_per_second",
              "Pixel samples per second accepted from a worker in the last minute.",
              worker.samples_per_second, labels(worker));
  }
}

void AddJobs(const FarmView& view, Families& out) {
  std::map<JobState, int> states;
  for (int state = 0; state <= static_cast<int>(kJobStateLast); ++state)
    states[static_cast<JobState>(state)] = 0;
  for (const JobStatus& job : view.jobs) ++states[job.state];
  for (const auto& [state, count] : states) {
    out.Gauge("tessera_jobs", "Jobs by state.", count, {{"state", JobStateName(state)}});
  }
  out.Gauge("tessera_samples_left", "Pixel samples of open jobs that are not merged yet.",
            D(view.samples_left));
}

void AddCoordinator(const FarmView& view, Families& out) {
  const FarmCounters& c = view.counters;
  out.Counter("tessera_core_seconds_total", "Time the coordinator spent on decisions and merging.", c.core_s);
  out.Counter("tessera_journal_sync_seconds_total",
              "Time the coordinator waited for the journal to be synced.", c.journal_s);
  out.Counter("tessera_journal_syncs_total", "Syncs of the journal.", D(c.journal_syncs));
  out.Counter("tessera_picture_seconds_total", "Time spent encoding and writing pictures.", c.picture_s);
  const char* const bytes = "tessera_bytes_total";
  const char* const help = "Bytes received and sent by the coordinator.";
  out.Counter(bytes, help, D(view.traffic.results_in), {{"direction", "in"}, {"what", "results"}});
  out.Counter(bytes, help, D(view.traffic.blobs_in), {{"direction", "in"}, {"what", "blobs"}});
  out.Counter(bytes, help, D(view.traffic.blobs_out), {{"direction", "out"}, {"what", "blobs"}});
  out.Gauge("tessera_intake_bytes", "Bytes of returned results in memory that are not on disk yet.",
            D(view.intake.bytes));
  out.Gauge("tessera_intake_waiting", "Calls that wait for memory to return results.",
            D(view.intake.waiting));
  out.Gauge("tessera_blob_bytes", "Bytes of scene files kept on disk.", D(view.blob_bytes));
}

}  // namespace

std::string MetricsText(const FarmView& view) {
  Families out;
  AddJobs(view, out);
  AddResults(view.counters, out);
  AddLeases(view, out);
  AddSlots(view, out);
  AddWorkers(view, out);
  AddCoordinator(view, out);
  return out.Text();
}

}  // namespace tessera
