// Where the farms of a chaos run are and which of their jobs still exist: what a customer must know to judge
// an answer. The thread that injects the faults writes it, those of the customers read it.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace tessera {

constexpr int kFarms = 2;

class FarmHistory {
 public:
  // When and where a job was accepted.
  struct Place {
    int farm = 0;
    uint64_t change = 0, backup = 0;
  };

  // ---- Of the thread that injects the faults.
  // Between the two, nobody can know which farm answers at an address, or with which jobs.
  void BeginChange();
  void EndChange();
  void SetAddress(int farm, std::string address);
  // The state of the farm was saved. Its coordinator is not running.
  void NoteBackup(int farm);
  // The farm has the state of its last backup. Called during a change.
  void NoteRestored(int farm);

  // ---- Of customers.
  // A number that is larger after each change, and odd during one.
  uint64_t change() const;
  std::string Address(int farm) const;
  // The place of a job that was accepted just now, with no change since it was submitted.
  Place Now(int farm) const;
  // Whether the job was submitted after the backup to which its farm was restored.
  bool IsLost(const Place& place) const;

 private:
  struct Restore {
    uint64_t change = 0, backup = 0;
  };
  struct Farm {
    std::string address;
    uint64_t backup = 0;  // number of the last one
    std::vector<Restore> restores;
  };
  mutable std::mutex mutex_;
  std::array<Farm, kFarms> farms_;
  uint64_t change_ = 0;
};

}  // namespace tessera
