#include "renderer/load/limited_load.h"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <mutex>
#include <new>
#include <optional>
#include <sstream>
#include <string>

#include "renderer/util/load_budget.h"
#include "renderer/util/threads.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

// Between looks at the clock and at the memory of the machine.
constexpr std::chrono::milliseconds kWatchInterval{50};
// Loading ends if less than one part in this many of the memory is left.
constexpr uint64_t kMemoryReserveParts = 50;
// Libraries have functions that allocate a little and must not throw. What they allocate counts, but is
// refused only if it adds up (LoadBudget::ChargeSmall).
constexpr size_t kSmallBytes = 1024;

// The number after `key` in a file of "KEY NUMBER" lines.
std::optional<uint64_t> NumberIn(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    uint64_t number = 0;
    if (words >> word >> number && word == key) return number;
  }
  return std::nullopt;
}

std::optional<uint64_t> MachineMemory(const std::string& key) {
  const auto kilobytes = NumberIn("/proc/meminfo", key + ":");
  return kilobytes ? std::optional(*kilobytes * 1024) : std::nullopt;
}

// The control group of this process (version 2), with its limit of memory.
struct MemoryGroup {
  std::string folder;
  uint64_t bytes_max = 0;
};

std::optional<MemoryGroup> FindMemoryGroup() {
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::/")) continue;
    MemoryGroup group{"/sys/fs/cgroup" + line.substr(3), 0};
    std::ifstream file(group.folder + "/memory.max");  // a number or "max"
    if (file >> group.bytes_max) return group;
  }
  return std::nullopt;
}

bool IsScarce(uint64_t available, uint64_t total) {
  return available < total / kMemoryReserveParts;
}

bool IsMemoryScarce() {
  const auto available = MachineMemory("MemAvailable");
  const auto total = MachineMemory("MemTotal");
  if (available && total && IsScarce(*available, *total)) return true;
  const auto group = FindMemoryGroup();
  if (!group) return false;
  uint64_t used = 0;
  if (!(std::ifstream(group->folder + "/memory.current") >> used)) return false;
  // The page cache is given back when it is needed.
  used -= std::min(used, NumberIn(group->folder + "/memory.stat", "file").value_or(0));
  return IsScarce(group->bytes_max - std::min(used, group->bytes_max), group->bytes_max);
}

// Looks at the clock and at the machine's memory while a scene is loaded.
class LoadWatch {
 public:
  // `name` and `limits` must outlive this.
  LoadWatch(LoadBudget& budget, const std::string& name, const LoadLimits& limits)
      : budget_(budget),
        name_(name),
        limits_(limits),
        thread_([&budget](const Error& why) { budget.Cancel(why.message); }) {}
  ~LoadWatch() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    over_.notify_all();
  }
  LoadWatch(const LoadWatch&) = delete;
  LoadWatch& operator=(const LoadWatch&) = delete;
  Result<void> Start() {
    return thread_.Start([this] { Run(); });
  }

 private:
  bool IsOverWithin(std::unique_lock<std::mutex>& lock, std::chrono::milliseconds time) {
    return over_.wait_for(lock, time, [this] { return is_over_; });
  }
  // Why loading must stop, or empty.
  std::string Problem(Clock::time_point deadline) const {
    if (Clock::now() > deadline)
      return fmt::format("loading the scene takes longer than {} s (--load-timeout)", limits_.time.count());
    return IsMemoryScarce() ? "the machine runs out of memory while it loads the scene" : "";
  }
  void Run() {
    const auto deadline = Clock::now() + limits_.time;
    std::string problem;
    std::unique_lock lock(mutex_);
    while (problem.empty()) {
      if (IsOverWithin(lock, kWatchInterval)) return;
      lock.unlock();
      problem = Problem(deadline);
      lock.lock();
    }
    budget_.Cancel(problem);
    if (IsOverWithin(lock, limits_.time_to_stop)) return;
    fmt::print(stderr, "{}: {}, and does not stop within {} s: this program ends\n", name_, problem,
               limits_.time_to_stop.count());
    std::_Exit(1);
  }

  LoadBudget& budget_;
  const std::string& name_;
  const LoadLimits& limits_;
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;  // guarded by mutex_
  ThreadGroup thread_;
};

void ChargeAllocation(LoadBudget& budget, size_t size) {
  if (budget.Charge(static_cast<int64_t>(size))) return;
  if (size > kSmallBytes || !budget.ChargeSmall(static_cast<int64_t>(size))) throw LoadBudgetExceeded();
}

void* Allocate(size_t size, size_t alignment) {
  void* const memory = alignment <= alignof(std::max_align_t)
                           ? std::malloc(std::max<size_t>(size, 1))
                           : std::aligned_alloc(alignment, (std::max<size_t>(size, 1) + alignment - 1) /
                                                               alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  if (LoadBudget* const budget = LoadBudget::Current()) {
    try {
      ChargeAllocation(*budget, ::malloc_usable_size(memory));
    } catch (...) {
      std::free(memory);
      throw;
    }
  }
  return memory;
}

void Free(void* memory) noexcept {
  if (LoadBudget* const budget = LoadBudget::Current(); budget != nullptr && memory != nullptr)
    budget->Charge(-static_cast<int64_t>(::malloc_usable_size(memory)));
  std::free(memory);
}

}  // namespace

uint64_t UsableMemory() {
  const uint64_t machine = MachineMemory("MemTotal").value_or(uint64_t{1} << 32);
  const auto group = FindMemoryGroup();
  return group ? std::min(machine, group->bytes_max) : machine;
}

uint64_t ResidentMemory() {
  uint64_t pages = 0, resident = 0;
  if (!(std::ifstream("/proc/self/statm") >> pages >> resident)) return 0;
  return resident * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
}

uint64_t DefaultSceneMemory() {
  return UsableMemory() / 2;
}

Result<void> RunWithinLimits(const std::string& name, const LoadLimits& limits,
                             const std::function<void()>& load) {
  LoadBudget budget(limits.memory_bytes,
                    fmt::format("loading the scene needs more than {} MiB of memory ({})",
                                limits.memory_bytes >> 20, limits.memory_source));
  LoadWatch watch(budget, name, limits);
  if (auto started = watch.Start(); !started) return started.error();
  std::string thrown;
  try {
    const LoadBudget::Scope scope(budget);
    load();
    // What is left of the scene after a refused allocation may be incomplete.
    if (!budget.is_exceeded()) return {};
  } catch (const std::exception& e) {
    thrown = e.what();
  }
  return Failed(fmt::format("{}: {}", name, budget.is_exceeded() ? budget.reason() : thrown));
}

}  // namespace tessera

// Replaces the allocation functions of the whole program; the others of the standard call these.
void* operator new(size_t size) {
  return tessera::Allocate(size, 0);
}
void* operator new(size_t size, std::align_val_t alignment) {
  return tessera::Allocate(size, static_cast<size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  tessera::Free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  tessera::Free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  tessera::Free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
  tessera::Free(memory);
}
