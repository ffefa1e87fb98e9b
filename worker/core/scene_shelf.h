// The scenes that a worker has in memory, is to get, or could not get. A pure state machine.
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

constexpr size_t kScenesHeldMax = 4;  // beyond those in use: a scene may take many gigabytes
constexpr std::chrono::seconds kSceneRetryInterval{
    5};  // before a scene that failed is tried again, if still wanted

// Not thread safe.
class SceneShelf {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using ScenePointer =
      std::shared_ptr<const Scene>;  // shared: slots keep a scene that leaves the shelf meanwhile

  // What the coordinator wants here now, the most wanted first. Lets go of others, longest unused first, that
  // are beyond kScenesHeldMax and not `in_use`.
  void Want(const std::vector<SceneOrder>& orders, const std::function<bool(const Digest&)>& in_use);
  // The next scene to load, which counts as loading from now on; nothing while there is none.
  std::optional<SceneOrder> StartLoading(TimePoint now);
  // When StartLoading may have something that it had not, if nothing else happens.
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
    uint64_t used = 0;   // by the count of uses of the shelf
  };
  std::vector<SceneOrder> wanted_;
  std::map<Digest, Entry> entries_;
  std::map<Digest, TimePoint> failed_;  // of those wanted, when
  uint64_t uses_ = 0;
};

}  // namespace tessera
