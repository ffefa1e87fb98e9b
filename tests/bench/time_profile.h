// Where a process spends its CPU time, by parts of the renderer: a sampling profiler.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// The parts that time is attributed to. What is computed by helpers without a part (vectors, hashes) belongs
// to the caller.
enum class TimePart { kTraversal, kShapes, kShading, kSampling, kTextures, kLights, kOther };
constexpr size_t kTimeParts = 7;
inline constexpr std::array<std::string_view, kTimeParts> kTimePartNames{
    "traversal", "shapes", "shading", "sampling", "textures", "lights", "other"};

// The part of each place in the code, as shares of the samples. They sum to 1, or are all 0 if there is no
// sample.
struct TimeShares {
  std::array<double, kTimeParts> of{};

  double Of(TimePart part) const { return of[static_cast<size_t>(part)]; }
};

// The part of a program counter whose source files are `files`: the file of its line, then those of the
// functions that this one is inlined into.
TimePart PartOfFiles(const std::vector<std::string>& files);
// The files of each address of the output of `addr2line -a -i`.
std::vector<std::vector<std::string>> ReadAddressFiles(std::string_view output);

// Samples the program counter of whatever thread of this process runs, at the clock tick of the kernel. At
// most one exists at any time.
class TimeProfiler {
 public:
  TimeProfiler();
  ~TimeProfiler();
  TimeProfiler(const TimeProfiler&) = delete;
  TimeProfiler& operator=(const TimeProfiler&) = delete;

  // Ends sampling. Source files are found by `addr2line`, which comes with the compiler; an error if it is
  // missing.
  Result<TimeShares> Finish();

 private:
  void Stop();
  bool runs_ = true;
};

}  // namespace tessera
