// Where facts survive a crash. Callers append the facts of a batch, sync once, then answer.
#pragma once

#include <vector>

#include "coordinator/core/fact.h"
#include "renderer/util/result.h"

namespace tessera {

// The space that facts are written to.
enum class Room {
  kFree,     // what the disk has
  kReserve,  // as well what is kept for facts that let space be freed
};

class Journal {
 public:
  virtual ~Journal() = default;
  // Keeps the fact in memory until Sync.
  virtual void Append(const Fact& fact) = 0;
  // All facts appended so far are on stable storage when this succeeds. When it fails they stay in memory,
  // nothing is lost, and Sync may be tried again. Cheap if nothing was appended.
  virtual Result<void> Sync(Room room = Room::kFree) = 0;
  // Whether most of the facts may be obsolete, so that Replace pays.
  virtual bool IsLarge() const = 0;
  // Replaces everything synced so far by `facts`, atomically. When it fails everything stays as it was.
  virtual Result<void> Replace(const std::vector<Fact>& facts) = 0;
};

}  // namespace tessera
