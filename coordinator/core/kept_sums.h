// Which finished frames have their sums still in the spool, so that they can be extended: as many as a limit
// of bytes allows, the first finished go first. Owned by the farm.
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

  // The youngest from now on. Those that have to go, maybe itself.
  std::vector<FrameId> Add(FrameId frame, uint64_t bytes);
  // False if it is not kept.
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
