#include "tests/chaos/slow_disk.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>

#include "tests/build_paths.h"

namespace tessera {

SlowDisk::SlowDisk(const std::string& folder) : path_(folder + "/slow-disk") {
  const int file = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  void* const memory = file >= 0 && ::ftruncate(file, sizeof *delay_ms_) == 0
                           ? ::mmap(nullptr, sizeof *delay_ms_, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                           : MAP_FAILED;
  if (file >= 0) ::close(file);
  if (memory == MAP_FAILED) throw std::runtime_error(path_ + ": cannot be mapped");
  delay_ms_ = static_cast<std::atomic<int32_t>*>(memory);
}

SlowDisk::~SlowDisk() {
  ::munmap(delay_ms_, sizeof *delay_ms_);
}

// The runtime of a sanitizer has to be loaded before any other library.
std::string SlowDisk::Library() {
#if defined(TESSERA_SLOW_DISK_LIBRARY)
  return TESSERA_SLOW_DISK_LIBRARY;
#else
  return {};
#endif
}

std::vector<std::string> SlowDisk::Prefix() const {
  if (Library().empty()) return {};
  return {"/usr/bin/env", "LD_PRELOAD=" + Library(), std::string(kSlowDiskVariable) + "=" + path_};
}

void SlowDisk::Slow(std::chrono::milliseconds delay, Clock::duration duration) {
  until_ = Clock::now() + duration;
  *delay_ms_ = static_cast<int32_t>(delay.count());
}

void SlowDisk::Tick() {
  if (is_slow() && Clock::now() >= until_) End();
}

}  // namespace tessera
