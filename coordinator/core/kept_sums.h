// Which finished frames still have their sums in the spool, so that they can be extended: as many as a limit
// of bytes allows; those that were finished first are dropped first. Owned by the farm.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <vector>

#include "coordinator/core/spool.h"

namespace tessera {

class KeptSums {
 public:
  explicit KeptSums(uint64_t bytes_max) : bytes_max_(bytes_max) {}

  // Adds the frame as the youngest. Returns the frames that are dropped for it, maybe the frame itself.
  std::vector<FrameId> Add(FrameId frame, uint64_t bytes);
  // Returns false if the frame is not kept.
  bool Remove(FrameId frame);
  bool Has(FrameId frame) const { return places_.contains(frame); }
  // Oldest first.
  std::vector<FrameId> Frames() const;
  bool keeps_any() const { return bytes_max_ > 0; }
  uint64_t bytes() const { return bytes_; }

 private:
  struct Kept {
    FrameId frame;
    uint64_t bytes = 0;
  };
  const uint64_t bytes_max_;
  uint64_t bytes_ = 0;
  std::list<Kept> kept_;  // oldest first
  std::map<FrameId, std::list<Kept>::iterator> places_;
};

}  // namespace tessera
