// Where accepted results survive a crash. Callers append the results of a batch, sync once, then answer. What
// is kept of a frame is a set of nodes of its tiles' trees: their order does not matter, copies and nodes
// that others cover do no harm. So what was appended may be replaced at any time by the sums that a merger
// made of it.
#pragma once

#include <compare>
#include <functional>
#include <vector>

#include "proto/terms.h"
#include "renderer/film/merger.h"
#include "renderer/util/result.h"

namespace tessera {

struct FrameId {
  JobId job{};
  uint32_t frame = 0;
  auto operator<=>(const FrameId&) const = default;
};

// Not thread safe: one thread calls it.
class Spool {
 public:
  virtual ~Spool() = default;
  // Keeps the node in memory until Sync.
  virtual void Append(FrameId frame, TileNode node) = 0;
  // All nodes appended so far are on stable storage when this succeeds. When it fails they stay in memory,
  // nothing is lost, and Sync may be tried again. Cheap if nothing was appended.
  virtual Result<void> Sync() = 0;
  // Frames of which enough was appended that it should be replaced.
  virtual std::vector<FrameId> Grown() const = 0;
  // `nodes` hold all that was appended for the frame so far: they replace it later, atomically. Until then,
  // and if that fails, what was synced stays as it is. What is appended from now on is kept beside them.
  virtual void Replace(FrameId frame, std::vector<TileNode> nodes) = 0;
  // The frame's nodes are not needed any more. Does nothing if there are none.
  virtual void Drop(FrameId frame) = 0;
  // Reads back what was synced of the frame before this call, and maybe some of what was synced since. Calls
  // `done` once, on any thread.
  using OnLoaded = std::function<void(Result<std::vector<TileNode>> nodes)>;
  virtual void Load(FrameId frame, OnLoaded done) = 0;
};

}  // namespace tessera
