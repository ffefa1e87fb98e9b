// A disk that takes long for a while: slow_disk_library.cpp is loaded into a coordinator and delays what it
// writes and syncs.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "tests/chaos/lasting_fault.h"

namespace tessera {

// The environment variable with the path of a file that holds the delay: an int32_t, in milliseconds.
constexpr const char* kSlowDiskVariable = "TESSERA_SLOW_DISK";

class SlowDisk : public LastingFault {
 public:
  // Creates the file in `folder`.
  explicit SlowDisk(const std::string& folder);
  ~SlowDisk() override;
  SlowDisk(const SlowDisk&) = delete;
  SlowDisk& operator=(const SlowDisk&) = delete;

  // The path of the library. Empty if it cannot be loaded into the programs of this build.
  static std::string Library();
  // Words of a command line that runs the rest of it with the library, if there is one.
  std::vector<std::string> Prefix() const;
  // Every write and sync of a coordinator takes this much longer.
  void Slow(std::chrono::milliseconds delay, Clock::duration duration);
  bool is_slow() const { return delay_ms_->load() > 0; }
  void Tick() override;
  void End() override { *delay_ms_ = 0; }

 private:
  std::string path_;
  std::atomic<int32_t>* delay_ms_ = nullptr;  // mapped
  Clock::time_point until_;
};

}  // namespace tessera
