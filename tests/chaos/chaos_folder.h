// The folder of a chaos run, and what fills its disk.
#pragma once

#include <string>

#include "tests/chaos/lasting_fault.h"

namespace tessera {

// A folder under /tmp that is removed with its contents. Must be made before any thread is started.
class ChaosFolder {
 public:
  // The data directories lie on a small file system of their own if that is asked for.
  explicit ChaosFolder(bool small_disk);
  ~ChaosFolder();
  ChaosFolder(const ChaosFolder&) = delete;
  ChaosFolder& operator=(const ChaosFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string disk() const { return path_ + "/disk"; }
  std::string Cache(int worker) const { return path_ + "/cache-w" + std::to_string(worker); }
  // Why there is no small file system, or empty.
  const std::string& mount_error() const { return mount_error_; }

 private:
  std::string path_, mount_error_;
  bool is_mounted_ = false;
};

// Uses up all space of a file system for a while.
class DiskFiller : public LastingFault {
 public:
  explicit DiskFiller(const std::string& folder) : path_(folder + "/filler") {}
  bool is_full() const { return until_ != Clock::time_point(); }
  void Fill(Clock::duration duration);
  void Tick() override;
  void End() override;

 private:
  const std::string path_;
  Clock::time_point until_;
};

}  // namespace tessera
