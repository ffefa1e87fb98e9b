// Where facts go to survive. The rule of whoever uses it: append the facts of a batch, sync once, then
// answer.
#pragma once

#include "core/fact.h"
#include "util/result.h"

namespace tessera {

class Journal {
 public:
  virtual ~Journal() = default;
  // Keeps the fact in memory until Sync.
  virtual void Append(const Fact& fact) = 0;
  // All facts appended so far are on stable storage when this succeeds. When it fails they stay in memory,
  // nothing is lost, and Sync may be tried again. Cheap if nothing was appended.
  virtual Result<void> Sync() = 0;
};

}  // namespace tessera
