#include "tests/bench/time_profile.h"

#include <fmt/format.h>
#include <link.h>
#include <signal.h>
#include <sys/time.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>
#include <utility>

namespace tessera {
namespace {

constexpr size_t kSamplesMax = 1 << 20;  // more than an hour on two processors
constexpr long kInterval_us = 1000;      // the kernel rounds it up to its tick

struct SampleBuffer {
  std::array<uintptr_t, kSamplesMax> counters;
  std::atomic<size_t> count{0};
};

// Of the one profiler. Not its member: a signal may be on its way when it ends.
SampleBuffer g_samples;
std::atomic<bool> g_is_sampling{false};

// Signal safe.
void OnTick(int, siginfo_t*, void* context) {
  if (!g_is_sampling.load(std::memory_order_acquire)) return;
  const size_t place = g_samples.count.fetch_add(1, std::memory_order_relaxed);
  if (place >= kSamplesMax) return;
  g_samples.counters[place] =
      static_cast<uintptr_t>(static_cast<const ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
}

void SetTimer(long interval_us) {
  itimerval timer{};
  timer.it_interval.tv_usec = timer.it_value.tv_usec = interval_us;
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

// A file that is loaded, with the addresses that it occupies.
struct LoadedFile {
  std::string name;  // empty: the program
  uintptr_t base = 0;
  std::vector<std::pair<uintptr_t, uintptr_t>> segments;

  bool Contains(uintptr_t address) const {
    return std::ranges::any_of(
        segments, [=](const auto& segment) { return address >= segment.first && address < segment.second; });
  }
};

std::vector<LoadedFile> LoadedFiles() {
  std::vector<LoadedFile> files;
  const auto add = [](dl_phdr_info* info, size_t, void* out) {
    LoadedFile file{info->dlpi_name, info->dlpi_addr, {}};
    for (int i = 0; i < info->dlpi_phnum; ++i) {
      const auto& header = info->dlpi_phdr[i];
      const uintptr_t start = info->dlpi_addr + header.p_vaddr;
      if (header.p_type == PT_LOAD) file.segments.emplace_back(start, start + header.p_memsz);
    }
    static_cast<std::vector<LoadedFile>*>(out)->push_back(std::move(file));
    return 0;
  };
  ::dl_iterate_phdr(add, &files);
  return files;
}

// The name of the box of a source file of the renderer: "bxdf" of ".../renderer/bxdf/bsdf.h"; empty for any
// other file.
std::string_view BoxOf(std::string_view file) {
  constexpr std::string_view kFolder = "/renderer/";
  const size_t at = file.rfind(kFolder);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = file.substr(at + kFolder.size());
  const size_t end = rest.find('/');
  return end == std::string_view::npos ? std::string_view() : rest.substr(0, end);
}

struct BoxPart {
  std::string_view box;
  TimePart part;
};
// Boxes that are not named here only help those that call them.
constexpr BoxPart kBoxParts[] = {
    {"accelerator", TimePart::kTraversal}, {"shape", TimePart::kShapes},
    {"bxdf", TimePart::kShading},          {"bssrdf", TimePart::kShading},
    {"material", TimePart::kShading},      {"integrator", TimePart::kShading},
    {"medium", TimePart::kShading},        {"sampler", TimePart::kSampling},
    {"texture", TimePart::kTextures},      {"image", TimePart::kTextures},
    {"light", TimePart::kLights},          {"camera", TimePart::kOther},
    {"filter", TimePart::kOther},          {"film", TimePart::kOther},
    {"scene", TimePart::kOther},
};

// Runs addr2line for addresses of this program.
Result<std::vector<std::vector<std::string>>> FilesOf(const std::vector<uintptr_t>& addresses) {
  std::error_code error;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe", error).string();
  char path[] = "/tmp/tessera_addresses_XXXXXX";
  const int fd = ::mkstemp(path);
  if (error || fd < 0) return Failed("cannot write the addresses to be looked up");
  FILE* const list = ::fdopen(fd, "w");
  for (const uintptr_t address : addresses) fmt::print(list, "{:x}\n", address);
  std::fclose(list);
  const std::string command = fmt::format("addr2line -a -i -e '{}' < '{}' 2>/dev/null", program, path);
  std::string output;
  if (FILE* const pipe = ::popen(command.c_str(), "r")) {
    char buffer[4096];
    for (size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, got);
    ::pclose(pipe);
  }
  ::unlink(path);
  auto files = ReadAddressFiles(output);
  if (files.size() != addresses.size())
    return Failed("addr2line, of the package binutils, does not work: no shares of time");
  return files;
}

}  // namespace

TimePart PartOfFiles(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const auto found = std::ranges::find(kBoxParts, BoxOf(file), &BoxPart::box);
    if (found != std::end(kBoxParts)) return found->part;
  }
  return TimePart::kOther;
}

std::vector<std::vector<std::string>> ReadAddressFiles(std::string_view output) {
  std::vector<std::vector<std::string>> all;
  for (size_t start = 0; start < output.size();) {
    const size_t end = std::min(output.find('\n', start), output.size());
    const std::string_view line = output.substr(start, end - start);
    if (line.starts_with("0x")) {
      all.emplace_back();
    } else if (!all.empty()) {
      all.back().emplace_back(line.substr(0, line.rfind(':')));
    }
    start = end + 1;
  }
  return all;
}

TimeProfiler::TimeProfiler() {
  g_samples.count = 0;
  g_is_sampling.store(true, std::memory_order_release);
  struct sigaction action {};
  action.sa_sigaction = OnTick;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  ::sigaction(SIGPROF, &action, nullptr);
  SetTimer(kInterval_us);
}

TimeProfiler::~TimeProfiler() {
  Stop();
}

void TimeProfiler::Stop() {
  if (!std::exchange(runs_, false)) return;
  SetTimer(0);
  g_is_sampling.store(false, std::memory_order_release);
}

Result<TimeShares> TimeProfiler::Finish() {
  Stop();
  const size_t count = std::min(g_samples.count.load(), kSamplesMax);
  const std::vector<LoadedFile> loaded = LoadedFiles();
  std::array<double, kTimeParts> counts{};
  std::vector<uintptr_t> own;  // addresses in the program
  for (size_t i = 0; i < count; ++i) {
    const uintptr_t counter = g_samples.counters[i];
    const auto file =
        std::ranges::find_if(loaded, [counter](const LoadedFile& each) { return each.Contains(counter); });
    const bool is_known = file != loaded.end();
    if (is_known && file->name.empty()) {
      own.push_back(counter - file->base);
    } else {
      const bool is_embree = is_known && file->name.find("libembree") != std::string::npos;
      ++counts[static_cast<size_t>(is_embree ? TimePart::kTraversal : TimePart::kOther)];
    }
  }
  if (!own.empty()) {
    const auto files = FilesOf(own);
    if (!files) return files.error();
    for (const std::vector<std::string>& each : *files) ++counts[static_cast<size_t>(PartOfFiles(each))];
  }
  TimeShares shares;
  const double total = std::accumulate(counts.begin(), counts.end(), 0.0);
  for (size_t i = 0; i < kTimeParts && total > 0; ++i) shares.of[i] = counts[i] / total;
  return shares;
}

}  // namespace tessera
