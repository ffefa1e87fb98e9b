#include "coordinator/status_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr size_t kJobsShownMax = 200;     // the newest
constexpr size_t kWorkersShownMax = 500;  // so that the page stays readable
constexpr int kRefresh_s = 3;

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--ink:#1c2330;--soft:#6a7386;--line:#e3e7ee;--card:#fff;--back:#f4f6f9;--bar:#2f6fde;
--good:#1f9d61;--bad:#d0433f;--warn:#c98a10}
@media(prefers-color-scheme:dark){:root{--ink:#e6eaf2;--soft:#939db1;--line:#2b3342;--card:#1a202b;--back:#11151c;
--bar:#5b93f5}}
*{box-sizing:border-box}body{margin:0;padding:28px 32px;background:var(--back);color:var(--ink);
font:14px/1.45 system-ui,sans-serif}h1{font-size:20px;margin:0}h2{font-size:15px;margin:28px 0 8px}
.tiles{display:flex;flex-wrap:wrap;gap:12px;margin-top:18px}
.tile{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:10px 16px;min-width:130px}
.tile b{display:block;font-size:20px;font-variant-numeric:tabular-nums}.tile span,.none,small{color:var(--soft)}
table{width:100%;border-collapse:collapse;background:var(--card);border:1px solid var(--line);border-radius:10px;
overflow:hidden}th,td{padding:7px 12px;text-align:left;border-top:1px solid var(--line)}
th{border-top:0;color:var(--soft);font-weight:500;font-size:12px}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.name{max-width:340px;overflow:hidden;text-overflow:ellipsis;white-space:nowrap}
.bar{width:150px;height:8px;border-radius:4px;background:var(--line);overflow:hidden;display:inline-block;
vertical-align:middle;margin-right:8px}.bar i{display:block;height:100%;background:var(--bar)}
.state{padding:1px 9px;border-radius:9px;background:var(--line);font-size:12px}
.running,.rendering{background:var(--bar);color:#fff}.finished{background:var(--good);color:#fff}
.failed,.quarantined{background:var(--bad);color:#fff}.paused,.draining{background:var(--warn);color:#fff}
)";

// Three digits or so and a metric prefix.
std::string Rounded(double value) {
  size_t prefix = 0;
  for (; value >= 1000 && prefix < 4; ++prefix) value /= 1000;
  constexpr const char* kPrefixes[] = {" ", " k", " M", " G", " T"};
  return fmt::format("{:.{}f}{}", value, prefix == 0 || value >= 100 ? 0 : 1, kPrefixes[prefix]);
}

std::string Duration(std::chrono::milliseconds duration) {
  const int64_t s = duration.count() / 1000;
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string Bar(double share) {
  const double percent = 100 * std::clamp(share, 0.0, 1.0);
  return fmt::format("<span class=bar><i style=\"width:{:.1f}%\"></i></span>{:.1f} %", percent, percent);
}

std::string State(std::string_view state) {
  return fmt::format("<span class=\"state {0}\">{0}</span>", state);
}

std::string Tile(const std::string& value, const char* what) {
  return fmt::format("<div class=tile><b>{}</b><span>{}</span></div>\n", value, what);
}

std::string JobRow(const JobStatus& job) {
  const double total = static_cast<double>(std::max<uint64_t>(job.samples_total, 1));
  const std::string left = job.left.count() >= 0 && !HasEnded(job.state) ? Duration(job.left) : "";
  return fmt::format(
      "<tr><td class=n>{}</td><td class=name title=\"{}\">{}</td><td>{}</td><td>{}{}</td><td>{}</td><td "
      "class=n>{} / "
      "{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td></tr>\n",
      Number(job.job), EscapeHtml(job.name), EscapeHtml(job.name), EscapeHtml(job.owner.name),
      State(JobStateName(job.state)),
      job.reason.empty() ? "" : fmt::format(" <small>{}</small>", EscapeHtml(job.reason)),
      Bar(static_cast<double>(job.samples_done) / total), job.frames_finished, job.frames_total,
      Rounded(job.samples_per_second), job.workers, Duration(job.elapsed), left);
}

const char* StateOf(const WorkerStatus& worker) {
  if (worker.quarantined) return "quarantined";
  if (worker.draining) return "draining";
  if (worker.leases > 0) return "rendering";
  if (worker.fetching) return "fetching";
  return worker.loading ? "loading" : "idle";
}

std::string WorkerRow(const WorkerStatus& worker) {
  return fmt::format(
      "<tr><td class=name title=\"{:016x}\">{}</td><td>{}{}</td><td>{}</td><td class=n>{}</td><td "
      "class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{:.2f}</td><td "
      "class=n>{}</td></tr>\n",
      Number(worker.worker), EscapeHtml(worker.name), State(StateOf(worker)),
      worker.reason.empty() ? "" : fmt::format(" <small>{}</small>", EscapeHtml(worker.reason)),
      Bar(worker.utilisation), worker.slots, Rounded(worker.samples_per_second), worker.units_finished,
      worker.units_failed, worker.speed, Duration(worker.silent));
}

std::string Jobs(const FarmView& view) {
  if (view.jobs.empty()) return "<p class=none>No jobs yet.</p>\n";
  std::string rows =
      "<table><tr><th class=n>job<th>name<th>owner<th>state<th>done<th class=n>frames<th "
      "class=n>samples/s<th "
      "class=n>workers<th class=n>elapsed<th class=n>left</tr>\n";
  const size_t shown = std::min(view.jobs.size(), kJobsShownMax);
  for (size_t i = 0; i < shown; ++i) rows += JobRow(view.jobs[view.jobs.size() - 1 - i]);
  rows += "</table>\n";
  if (shown < view.jobs.size())
    rows += fmt::format("<p class=none>{} older jobs are not shown.</p>\n", view.jobs.size() - shown);
  return rows;
}

std::string Workers(const FarmView& view) {
  if (view.workers.empty()) return "<p class=none>No workers are connected.</p>\n";
  std::string rows =
      "<table><tr><th>name<th>state<th>busy, last minute<th class=n>slots<th class=n>samples/s<th "
      "class=n>units<th class=n>failed<th class=n>speed<th class=n>last seen</tr>\n";
  const size_t shown = std::min(view.workers.size(), kWorkersShownMax);
  for (size_t i = 0; i < shown; ++i) rows += WorkerRow(view.workers[i]);
  rows += "</table>\n";
  if (shown < view.workers.size())
    rows += fmt::format("<p class=none>{} more workers are not shown.</p>\n", view.workers.size() - shown);
  return rows;
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string escaped;
  for (const char c : CleanText(text, kReasonBytesMax)) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\'': escaped += "&#39;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

std::string StatusPage(const FarmView& view) {
  const SlotUse& slots = view.slots;
  const int all = slots.leased + slots.fetching + slots.loading + slots.idle;
  double rate = 0;
  for (const JobStatus& job : view.jobs) rate += HasEnded(job.state) ? 0 : job.samples_per_second;
  std::string page = fmt::format(
      "<!doctype html><html lang=en><head><meta charset=utf-8><title>Tessera farm</title>\n<meta "
      "http-equiv=refresh content={}><meta name=viewport content=\"width=device-width\">\n"
      "<style>{}</style></head><body>\n<h1>Tessera farm</h1>\n<div class=tiles>\n",
      kRefresh_s, kStyle);
  page += Tile(fmt::format("{}", view.workers.size()), "workers");
  page += Tile(fmt::format("{} / {}", slots.leased, all), "slots leased");
  page += Tile(Rounded(rate), "samples/s");
  page += Tile(Rounded(static_cast<double>(view.samples_left)), "samples left");
  page += Tile(fmt::format("{}", view.leases), "units leased");
  page += Tile(Rounded(static_cast<double>(view.blob_bytes)) + "B", "of scene files");
  page += fmt::format("</div>\n<h2>Jobs</h2>\n{}<h2>Workers</h2>\n{}", Jobs(view), Workers(view));
  page += "<p class=none>Metrics for Prometheus: <a href=/metrics>/metrics</a></p>\n</body></html>\n";
  return page;
}

}  // namespace tessera
