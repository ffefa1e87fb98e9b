#include "coordinator/web/api/event_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coordinator/web/api/json_views.h"

namespace tessera {
namespace {

// The lines of an event. JSON text has no line breaks.
std::string EventText(const char* name, const nlohmann::json& data) {
  return fmt::format("event: {}\ndata: {}\n\n", name, JsonText(data));
}

}  // namespace

std::optional<EventSource::Event> EventSource::Newest(std::optional<JobId> job) {
  const FarmWatch::Moment moment = watch_.Latest();
  if (moment == nullptr) return std::nullopt;
  const std::lock_guard lock(mutex_);
  if (moment->number != number_) {
    number_ = moment->number;
    farm_ = std::make_shared<const std::string>(EventText("farm", FarmJson(*moment)));
    jobs_.clear();
  }
  if (!job) return Event{number_, farm_};
  BodyStream::Part& text = jobs_[*job];
  if (text == nullptr) {
    const auto& jobs = moment->view.jobs;
    const auto found = std::ranges::lower_bound(jobs, *job, {}, &JobStatus::job);
    const bool is_known = found != jobs.end() && found->job == *job;
    text = std::make_shared<const std::string>(
        *farm_ + EventText("job", is_known ? JobJson(*found) : nlohmann::json(nullptr)));
  }
  return Event{number_, text};
}

EventStream::Next EventStream::Take(std::vector<Part>& parts) {
  const auto event = source_->Newest(job_);
  if (!event || event->number == sent_) return Next::kLater;
  sent_ = event->number;
  parts.push_back(event->text);
  return Next::kParts;
}

}  // namespace tessera
