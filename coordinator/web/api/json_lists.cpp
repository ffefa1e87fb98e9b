#include "coordinator/web/api/json_lists.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "coordinator/core/schedule/instant.h"
#include "coordinator/web/api/json_views.h"

namespace tessera {
namespace {

using nlohmann::json;

constexpr uint64_t kPageMax = 1000;
constexpr uint64_t kPageDefault = 100;
// With the history of each, some 5 KB.
constexpr uint64_t kHistoryPageMax = 200;

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
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
         return SortKey{Seconds(job.left), ""};
       }},
      {"elapsed",
       [](const Job& job) {
         return SortKey{Seconds(job.elapsed), ""};
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
         return SortKey{Seconds(worker.silent), ""};
       }},
  };
  return rules;
}

}  // namespace

WebResult<json> JobsJson(const FarmView& view, const Query& query) {
  return ListJson(view.jobs, query, kPageMax, JobRules(query));
}

WebResult<json> WorkersJson(const FarmWatch& watch, const FarmView& view, const Query& query) {
  const bool has_history = query.contains("history");
  return ListJson(view.workers, query, has_history ? kHistoryPageMax : kPageMax,
                  WorkerRules(query, has_history ? &watch : nullptr));
}

}  // namespace tessera
