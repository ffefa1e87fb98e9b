// The scenes that a worker holds, is to load or could not load. A pure state machine: time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "proto/terms.h"

namespace tessera {

class Scene;

// Besides those in use: a scene may take many gigabytes.
constexpr size_t kScenesHeldMax = 4;
// Before a scene that failed is tried again, if it is still wanted.
constexpr std::chrono::seconds kSceneRetryInterval{5};

// Not thread safe.
class SceneTable {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  // Shared: slots keep using a scene that is evicted meanwhile.
  using ScenePointer = std::shared_ptr<const Scene>;

  // Sets the scenes that the coordinator wants here, the most urgent first. Evicts others beyond
  // kScenesHeldMax that are not `in_use`, the least recently used first.
  void Want(const std::vector<SceneRequest>& orders, const std::function<bool(const Digest&)>& in_use);
  // The next scene to load, which counts as loading from now on; nullopt if there is none.
  std::optional<SceneRequest> StartLoading(TimePoint now);
  // When StartLoading may return a scene that failed before, if nothing else changes.
  std::optional<TimePoint> NextRetry() const;
  void Loaded(const Digest& key, ScenePointer scene);
  void Failed(const Digest& key, TimePoint now);
  bool IsReady(const Digest& key) const;
  // Whether it is ready, loading or wanted.
  bool Expects(const Digest& key) const;
  // Null if it is not ready.
  ScenePointer Use(const Digest& key);
  // For the next Synchronize.
  std::vector<HeldScene> Held() const;

 private:
  struct Entry {
    ScenePointer scene;  // null: loading
    uint64_t used = 0;   // value of uses_ at its last use
  };
  std::vector<SceneRequest> wanted_;
  std::map<Digest, Entry> entries_;
  std::map<Digest, TimePoint> failed_;  // scenes that are wanted, and when they failed
  uint64_t uses_ = 0;
};

}  // namespace tessera
