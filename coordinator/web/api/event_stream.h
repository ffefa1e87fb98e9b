// Server-sent events (WHATWG HTML, section 9.2): what changes on the farm, about once per second. Events are
// made once per view for all readers. A reader that is slow misses some and always gets the newest.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "coordinator/web/api/farm_watch.h"
#include "coordinator/web/http_response.h"

namespace tessera {

// Thread safe.
class EventSource {
 public:
  explicit EventSource(FarmWatch& watch) : watch_(watch) {}

  struct Event {
    uint64_t number = 0;  // of the view
    BodyStream::Part text;
  };
  // Events `farm` and, if a job is named, `job` of the newest view; nullopt if there was none yet.
  std::optional<Event> Newest(std::optional<JobId> job);

 private:
  FarmWatch& watch_;
  std::mutex mutex_;
  // Guarded by mutex_; of the newest view alone.
  uint64_t number_ = 0;
  BodyStream::Part farm_;
  std::map<JobId, BodyStream::Part> jobs_;
};

class EventStream final : public BodyStream {
 public:
  EventStream(std::shared_ptr<EventSource> source, std::optional<JobId> job)
      : source_(std::move(source)), job_(job) {}
  Next Take(std::vector<Part>& parts) override;

 private:
  const std::shared_ptr<EventSource> source_;
  const std::optional<JobId> job_;
  uint64_t sent_ = 0;
};

}  // namespace tessera
