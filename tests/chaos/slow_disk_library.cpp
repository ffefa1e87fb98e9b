// Loaded into a program with LD_PRELOAD: delays writes to files and syncs by what slow_disk.h names. Links
// nothing of ours.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>

namespace {

const std::atomic<int32_t>* MapDelay() {
  const char* const path = std::getenv("TESSERA_SLOW_DISK");
  const int file = path != nullptr ? ::open(path, O_RDONLY | O_CLOEXEC) : -1;
  if (file < 0) return nullptr;
  void* const memory = ::mmap(nullptr, sizeof(int32_t), PROT_READ, MAP_SHARED, file, 0);
  ::close(file);
  return memory == MAP_FAILED ? nullptr : static_cast<const std::atomic<int32_t>*>(memory);
}

void Delay() {
  static const std::atomic<int32_t>* const delay_ms = MapDelay();
  const long ms = delay_ms != nullptr ? delay_ms->load() : 0;
  if (ms <= 0) return;
  const timespec duration{ms / 1000, ms % 1000 * 1'000'000};
  ::nanosleep(&duration, nullptr);
}

template <typename Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int fsync(int file) {
  static auto* const real = Real<int(int)>("fsync");
  Delay();
  return real(file);
}

int fdatasync(int file) {
  static auto* const real = Real<int(int)>("fdatasync");
  Delay();
  return real(file);
}

ssize_t pwritev(int file, const iovec* pieces, int count, off_t offset) {
  static auto* const real = Real<ssize_t(int, const iovec*, int, off_t)>("pwritev");
  Delay();
  return real(file, pieces, count, offset);
}

ssize_t pwritev64(int file, const iovec* pieces, int count, off64_t offset) {
  static auto* const real = Real<ssize_t(int, const iovec*, int, off64_t)>("pwritev64");
  Delay();
  return real(file, pieces, count, offset);
}
}
