#include "tests/bench/process_cost.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace tessera {
namespace {

// For /bin/sh.
std::string Quote(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

double PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void ResetPeakMemory() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

uint64_t ReadInstructionCount(const std::string& output) {
  // ==123== I   refs:      1,234,567
  const size_t at = output.find("I   refs:");
  if (at == std::string::npos) return 0;
  uint64_t count = 0;
  for (size_t i = output.find(':', at) + 1; i < output.size() && output[i] != '\n'; ++i) {
    if (output[i] >= '0' && output[i] <= '9') count = 10 * count + static_cast<uint64_t>(output[i] - '0');
  }
  return count;
}

Result<uint64_t> CountInstructions(const std::vector<std::string>& arguments) {
  std::error_code error;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe", error).string();
  std::string command =
      "valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null " + Quote(program);
  for (const std::string& argument : arguments) command += " " + Quote(argument);
  FILE* const pipe = ::popen((command + " 2>&1 >/dev/null").c_str(), "r");
  if (error || pipe == nullptr) return Failed("cannot start valgrind");
  std::string output;
  char buffer[4096];
  for (size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, got);
  const int status = ::pclose(pipe);
  const uint64_t count = ReadInstructionCount(output);
  if (status == 0 && count > 0) return count;
  return Failed(fmt::format("valgrind cannot count instructions: {}", output.substr(0, 500)));
}

}  // namespace tessera
