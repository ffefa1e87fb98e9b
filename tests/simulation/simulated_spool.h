// The coordinator's spool on a simulated disk: it may be full, and a crash loses some or all of what was not
// synced and may come before or after a file has replaced others.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "coordinator/core/spool.h"
#include "tests/simulation/random.h"

namespace tessera {

class SimulatedSpool : public Spool {
 public:
  void Append(FrameId frame, TileNode node) override;
  Result<void> Sync() override;
  std::vector<FrameId> Grown() const override;
  void Replace(FrameId frame, std::vector<TileNode> nodes) override;
  void Drop(FrameId frame) override;
  void Load(FrameId frame, OnLoaded done) override;

  void set_full(bool full) { full_ = full; }
  // The process is killed: some of what was on its way to the disk may be there.
  void Crash(Random& random);

  // What the next process finds.
  std::vector<FrameId> Frames() const;
  bool HasBegun(FrameId frame) const { return !files_.at(frame).segment.empty(); }
  std::vector<TileNode> Nodes(FrameId frame) const;

 private:
  struct Base {
    std::vector<TileNode> nodes;
    size_t covers = 0;  // nodes of the segment, from its start
  };
  struct Files {
    std::vector<TileNode> base, segment;  // synced
    std::vector<TileNode> pending;        // follow the segment
    std::optional<Base> next;             // written in the background
    void PutBase();
  };
  std::map<FrameId, Files> files_;
  std::map<FrameId, Files> dropped_;  // since the last sync: a crash may bring them back
  bool full_ = false;
};

}  // namespace tessera
