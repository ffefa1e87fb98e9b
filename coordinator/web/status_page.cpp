#include "coordinator/web/status_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "coordinator/web/html.h"
#include "coordinator/web/page_style.h"

namespace tessera {
namespace {

constexpr size_t kJobsShownMax = 200;     // the newest
constexpr size_t kWorkersShownMax = 500;  // so that the page stays readable
constexpr int kRefresh_s = 3;

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

void AddBar(Html& html, double share) {
  const double percent = 100 * std::clamp(share, 0.0, 1.0);
  html.Open("td").Open("progress", {{"max", "100"}, {"value", fmt::format("{:.1f}", percent)}}).Close();
  html.Text(fmt::format("{:.1f} %", percent)).Close();
}

void AddState(Html& html, std::string_view state, std::string_view reason) {
  html.Open("td").Element("span", state, {{"class", fmt::format("state {}", state)}});
  if (!reason.empty()) html.Text(" ").Element("small", reason);
  html.Close();
}

// Figures are aligned to the right.
void AddFigure(Html& html, const std::string& figure) {
  html.Element("td", figure, {{"class", "n"}});
}

void AddTile(Html& html, const std::string& value, const char* what) {
  html.Open("div", {{"class", "tile"}}).Element("b", value).Element("span", what).Close();
}

struct Column {
  const char* name;
  bool is_figure;
};

void AddHeads(Html& html, std::initializer_list<Column> columns) {
  html.Open("tr");
  for (const Column& each : columns) {
    if (each.is_figure) {
      html.Element("th", each.name, {{"class", "n"}});
    } else {
      html.Element("th", each.name);
    }
  }
  html.Close();
}

void AddJob(Html& html, const JobStatus& job) {
  const double total = static_cast<double>(std::max<uint64_t>(job.samples_total, 1));
  html.Open("tr");
  AddFigure(html, fmt::format("{}", Number(job.job)));
  html.Element("td", job.name, {{"class", "name"}, {"title", job.name}});
  html.Element("td", job.owner.name);
  AddState(html, JobStateName(job.state), job.reason);
  AddBar(html, static_cast<double>(job.samples_done) / total);
  AddFigure(html, fmt::format("{} / {}", job.frames_finished, job.frames_total));
  AddFigure(html, Rounded(job.samples_per_second));
  AddFigure(html, fmt::format("{}", job.workers));
  AddFigure(html, Duration(job.elapsed));
  AddFigure(html, job.left.count() >= 0 && !HasEnded(job.state) ? Duration(job.left) : "");
  html.Close().Add("\n");
}

const char* StateOf(const WorkerStatus& worker) {
  if (worker.quarantined) return "quarantined";
  if (worker.draining) return "draining";
  if (worker.leases > 0) return "rendering";
  if (worker.fetching) return "fetching";
  return worker.loading ? "loading" : "idle";
}

void AddWorker(Html& html, const WorkerStatus& worker) {
  html.Open("tr");
  html.Element("td", worker.name,
               {{"class", "name"}, {"title", fmt::format("{:016x}", Number(worker.worker))}});
  AddState(html, StateOf(worker), worker.reason);
  AddBar(html, worker.utilisation);
  AddFigure(html, fmt::format("{}", worker.slots));
  AddFigure(html, Rounded(worker.samples_per_second));
  AddFigure(html, fmt::format("{}", worker.units_finished));
  AddFigure(html, fmt::format("{}", worker.units_failed));
  AddFigure(html, fmt::format("{:.2f}", worker.speed));
  AddFigure(html, Duration(worker.silent));
  html.Close().Add("\n");
}

void AddNote(Html& html, const std::string& text) {
  html.Element("p", text, {{"class", "none"}});
}

void AddJobs(Html& html, const FarmView& view) {
  if (view.jobs.empty()) return AddNote(html, "No jobs yet.");
  html.Open("table");
  AddHeads(html, {{"job", true},
                  {"name", false},
                  {"owner", false},
                  {"state", false},
                  {"done", false},
                  {"frames", true},
                  {"samples/s", true},
                  {"workers", true},
                  {"elapsed", true},
                  {"left", true}});
  const size_t shown = std::min(view.jobs.size(), kJobsShownMax);
  for (size_t i = 0; i < shown; ++i) AddJob(html, view.jobs[view.jobs.size() - 1 - i]);
  html.Close();
  if (shown < view.jobs.size())
    AddNote(html, fmt::format("{} older jobs are not shown.", view.jobs.size() - shown));
}

void AddWorkers(Html& html, const FarmView& view) {
  if (view.workers.empty()) return AddNote(html, "No workers are connected.");
  html.Open("table");
  AddHeads(html, {{"name", false},
                  {"state", false},
                  {"busy, last minute", false},
                  {"slots", true},
                  {"samples/s", true},
                  {"units", true},
                  {"failed", true},
                  {"speed", true},
                  {"last seen", true}});
  const size_t shown = std::min(view.workers.size(), kWorkersShownMax);
  for (size_t i = 0; i < shown; ++i) AddWorker(html, view.workers[i]);
  html.Close();
  if (shown < view.workers.size())
    AddNote(html, fmt::format("{} more workers are not shown.", view.workers.size() - shown));
}

// Who is logged in, and the button that ends that.
void AddHeader(Html& html, const PageReader& reader) {
  html.Open("header").Element("h1", "Tessera farm");
  if (!reader.name.empty()) html.Element("small", fmt::format("{} ({})", reader.name, reader.role));
  if (!reader.logout_proof.empty()) {
    html.Open("form", {{"method", "post"}, {"action", "/logout"}});
    html.Void("input", {{"type", "hidden"}, {"name", "proof"}, {"value", reader.logout_proof}});
    html.Element("button", "Log out").Close();
  }
  html.Close();
}

}  // namespace

std::string StatusContent(const FarmView& view) {
  const SlotUse& slots = view.slots;
  const int all = slots.leased + slots.fetching + slots.loading + slots.idle;
  double rate = 0;
  for (const JobStatus& job : view.jobs) rate += HasEnded(job.state) ? 0 : job.samples_per_second;
  Html html;
  html.Open("div", {{"class", "tiles"}});
  AddTile(html, fmt::format("{}", view.workers.size()), "workers");
  AddTile(html, fmt::format("{} / {}", slots.leased, all), "slots leased");
  AddTile(html, Rounded(rate), "samples/s");
  AddTile(html, Rounded(static_cast<double>(view.samples_left)), "samples left");
  AddTile(html, fmt::format("{}", view.leases), "units leased");
  AddTile(html, Rounded(static_cast<double>(view.blob_bytes)) + "B", "of scene files");
  html.Close().Element("h2", "Jobs");
  AddJobs(html, view);
  html.Element("h2", "Workers");
  AddWorkers(html, view);
  html.Open("p", {{"class", "none"}}).Text("Metrics for Prometheus: ");
  html.Element("a", "/metrics", {{"href", "/metrics"}}).Close();
  return html.Take();
}

std::string StatusPage(const std::string& content, const PageReader& reader) {
  Html head, body;
  head.Void("meta", {{"http-equiv", "refresh"}, {"content", fmt::format("{}", kRefresh_s)}});
  AddHeader(body, reader);
  body.Add(content);
  return HtmlDocument("Tessera farm", kPageStyle, head.Take(), body.Take());
}

std::string LoginPage(const std::string& proof, const std::string& problem) {
  Html body;
  body.Open("main", {{"class", "login"}}).Element("h1", "Tessera farm");
  if (!problem.empty()) body.Element("p", problem, {{"class", "error"}, {"role", "alert"}});
  body.Open("form", {{"method", "post"}, {"action", "/login"}, {"autocomplete", "off"}});
  body.Void("input", {{"type", "hidden"}, {"name", "proof"}, {"value", proof}});
  body.Element("label", "Token from an operator", {{"for", "token"}});
  body.Void("input", {{"type", "password"},
                      {"name", "token"},
                      {"id", "token"},
                      {"autocomplete", "one-time-code"},
                      {"required", ""}});
  body.Element("button", "Log in").Close().Close();
  return HtmlDocument("Log in", kPageStyle, "", body.Take());
}

}  // namespace tessera
