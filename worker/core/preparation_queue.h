// Scenes that a worker is to prepare, and the reports of those that it has. Pure.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "proto/terms.h"

namespace tessera {

// Not thread safe.
class PreparationQueue {
 public:
  using Report = std::shared_ptr<const PreparationReport>;
  // Does nothing if the request is already queued or the queue is full (kPreparationsPerWorkerMax).
  void Add(const PreparationRequest& request);
  // Returns the next request, which is running from now on; nullopt if none waits.
  std::optional<PreparationRequest> Start();
  // Adds the report of a running request. Does nothing if the request has been removed in the meantime.
  void Finish(PreparationReport report);
  // The report that was finished first; null if there is none. It stays until it is answered.
  Report NextReport() const { return reports_.empty() ? nullptr : reports_.front(); }
  void Answered(const Digest& key);
  // The coordinator refuses the frames of a report: it gets the reason as a failure. Forgets a report without
  // frames.
  void Refuse(const Digest& key, const std::string& reason);
  // Reports it after the others.
  void Postpone();
  // Forgets those that were not begun.
  void Drain() { waiting_.clear(); }
  void Clear();
  // The keys of everything that waits, runs or has a report.
  std::vector<Digest> Held() const;

 private:
  bool Knows(const Digest& key) const;
  std::deque<PreparationRequest> waiting_;
  std::vector<Digest> running_;
  std::deque<Report> reports_;
};

}  // namespace tessera
