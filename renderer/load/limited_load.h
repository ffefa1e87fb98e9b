// Loads scenes within limits of memory and time. Allocations are accounted for: in a program with this file,
// operator new is the one in limited_load.cpp.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

// Cancelled loading ends within seconds, unless a library neither allocates nor returns.
constexpr std::chrono::seconds kTimeToStopLoading{600};

struct LoadLimits {
  uint64_t memory_bytes = 0;
  std::chrono::seconds time{0};
  std::string memory_source = "--scene-memory";  // for messages: what sets the limit
  // How long loading may continue after it was cancelled.
  std::chrono::seconds time_to_stop = kTimeToStopLoading;
};

// The least limit of memory that options take.
constexpr uint64_t kSceneMemoryMin = uint64_t{16} << 20;
// Far more than production scenes take to load.
constexpr std::chrono::seconds kLoadTimeDefault{3600};

// The memory that this process may use: that of the machine or, if less, of its control group.
uint64_t UsableMemory();
// The memory that this process has now, resident; 0 if it is unknown.
uint64_t ResidentMemory();
// By default one scene may take half of that, which leaves room for the scenes that are being rendered.
uint64_t DefaultSceneMemory();

// Calls `load` on this thread. An error, that `name` and the limit explain, if it allocates more memory than
// it frees beyond the limit, takes too long, or leaves the machine without memory. What `load` throws becomes
// an error, too. Memory that its libraries allocate with malloc is not accounted for. Ends the process, with
// a message and exit code 1, if `load` continues for `time_to_stop` after that: nothing else can end it.
Result<void> RunWithinLimits(const std::string& name, const LoadLimits& limits,
                             const std::function<void()>& load);

// The same for a `load` that returns a Result.
template <typename Load>
auto LoadWithinLimits(const std::string& name, const LoadLimits& limits, const Load& load)
    -> decltype(load()) {
  std::optional<decltype(load())> loaded;
  if (auto within = RunWithinLimits(name, limits, [&] { loaded.emplace(load()); }); !within)
    return within.error();
  return *std::move(loaded);
}

}  // namespace tessera
