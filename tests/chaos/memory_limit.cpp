#include "tests/chaos/memory_limit.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <string>

#include "tests/end_to_end/process.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kPoll{10};

uint64_t ResidentBytes(pid_t process) {
  std::ifstream pages("/proc/" + std::to_string(process) + "/statm");
  uint64_t total = 0, resident = 0;
  pages >> total >> resident;
  return resident * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

MemoryLimit::MemoryLimit(uint64_t bytes)
    : thread_([this, bytes](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
          KillLarge(bytes);
          std::this_thread::sleep_for(kPoll);
        }
      }) {}

void MemoryLimit::KillLarge(uint64_t bytes) {
  for (const pid_t worker : ChildrenOf(::getpid(), "tessera-worker")) {
    if (ResidentBytes(worker) <= bytes) continue;
    ::kill(worker, SIGKILL);
    ++kills_;
  }
}

}  // namespace tessera
