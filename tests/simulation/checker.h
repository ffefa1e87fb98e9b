// An observer of a simulation that holds one invariant against the farm. It sees what workers, clients and
// the disk see, and never changes anything. To add one: a file with a class, and a line in MakeCheckers.
#pragma once

#include <memory>
#include <vector>

#include "coordinator/core/farm.h"
#include "tests/simulation/world.h"

namespace tessera {

class Checker {
 public:
  explicit Checker(World& world) : world_(world) {}
  virtual ~Checker() = default;

  // A worker was told that its result counts. `unit` is what the worker rendered.
  virtual void OnAcknowledged(const WorkUnit&) {}
  // The fact is on stable storage, or was found there by a new process. The job models know of it already.
  virtual void OnFact(const Fact&) {}
  // A lease that was not granted before.
  virtual void OnLease(const Farm&, Instant, const Lease&) {}
  virtual void OnPicture(const FinishedPicture&) {}
  // A new process of the coordinator has read what former ones left.
  virtual void OnRestart(const Farm&, Instant) {}
  // The directory in use is in an earlier state: what the farm had promised since is forgotten.
  virtual void OnRestored() {}
  // The simulation is over; no farm if its process is dead.
  virtual void OnEnd(const Farm*, Instant) {}

 protected:
  World& world_;
};

std::vector<std::unique_ptr<Checker>> MakeCheckers(World& world);

// ---- The checkers, one file each ----
std::unique_ptr<Checker> MakePictureChecker(World& world);       // I2, I3: check_pictures.cpp
std::unique_ptr<Checker> MakeOriginChecker(World& world);        // I6: check_origin.cpp
std::unique_ptr<Checker> MakeMemoryChecker(World& world);        // I4: check_memory.cpp
std::unique_ptr<Checker> MakeRerenderChecker(World& world);      // I4: check_rerender.cpp
std::unique_ptr<Checker> MakeLeaseChecker(World& world);         // what may be leased: check_leases.cpp
std::unique_ptr<Checker> MakeVerificationChecker(World& world);  // who is trusted: check_verification.cpp
std::unique_ptr<Checker> MakeEndChecker(World& world);           // I5: check_end.cpp

}  // namespace tessera
