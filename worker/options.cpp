#include "worker/options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "proto/terms.h"
#include "renderer/util/cores.h"
#include "renderer/util/text.h"

namespace tessera {
namespace {

// What the user wrote, before it is believed.
struct Words {
  std::string coordinator, threads, cache_dir, cache_size, name;
  std::string log_level = kLogLevelDefault;
  std::vector<std::string> tags;
};

std::string Environment(const char* variable) {
  const char* set = std::getenv(variable);
  return set != nullptr ? set : "";
}

std::string HostName() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return *name != '\0' ? name : "worker";
}

std::string DefaultCacheDir() {
  const std::string cache = Environment("XDG_CACHE_HOME");
  if (!cache.empty()) return cache + "/tessera";
  const std::string home = Environment("HOME");
  return home.empty() ? "/tmp/tessera-cache" : home + "/.cache/tessera";
}

// Bytes, with K, M, G or T for powers of 1024.
Result<uint64_t> ParseSize(const std::string& word) {
  uint64_t number = 0;
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, number);
  const std::string_view unit(parsed.ptr, static_cast<size_t>(end - parsed.ptr));
  constexpr std::string_view kUnits = "KMGT";
  int shift = 0;
  if (unit.size() == 1 && kUnits.find(unit[0]) != std::string_view::npos) {
    shift = 10 * (static_cast<int>(kUnits.find(unit[0])) + 1);
  }
  const bool good =
      parsed.ec == std::errc() && (unit.empty() || shift > 0) && number <= (UINT64_MAX >> shift);
  if (!good || (number << shift) < kCacheBytesMin) {
    return BadInput(fmt::format(
        "--cache-size: \"{}\" is not a number of bytes, at least 1M; K, M, G, T may follow", word));
  }
  return number << shift;
}

Result<int> ParseThreads(const std::string& word) {
  int number = 0;
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end || number < 1 || number > kSlotsMax) {
    return BadInput(fmt::format("--threads: \"{}\" is not a whole number from 1 to {}", word, kSlotsMax));
  }
  return number;
}

Result<WorkerOptions> Check(const Words& words) {
  WorkerOptions options;
  if (words.coordinator.empty()) return BadInput("--coordinator HOST:PORT or unix:PATH is required");
  const auto address = ParseAddress(words.coordinator, "--coordinator");
  if (!address) return address.error();
  options.coordinator = *address;
  options.threads = UsableCores();
  if (!words.threads.empty()) {
    const auto threads = ParseThreads(words.threads);
    if (!threads) return threads.error();
    options.threads = *threads;
  }
  if (!words.cache_size.empty()) {
    const auto size = ParseSize(words.cache_size);
    if (!size) return size.error();
    options.cache_bytes = *size;
  }
  options.cache_dir = words.cache_dir.empty() ? DefaultCacheDir() : words.cache_dir;
  options.name = words.name.empty() ? HostName() : words.name;
  options.log_level = words.log_level;
  if (options.name.size() > kNameBytesMax) return BadInput("--name: is too long");
  for (const std::string& tag : words.tags) {
    if (!IsTag(tag)) {
      return BadInput(fmt::format("--tag: \"{}\" is not a word of letters, digits and . _ - + :", tag));
    }
    options.tags.insert(tag);
  }
  if (options.tags.size() > kTagsMax) return BadInput(fmt::format("--tag: more than {} tags", kTagsMax));
  return options;
}

std::string UnknownFlag(const CLI::App& app) {
  if (app.remaining().empty()) return {};
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  const std::vector<std::string_view> candidates(known.begin(), known.end());
  const std::string word = app.remaining().front().substr(0, app.remaining().front().find('='));
  return fmt::format("unknown flag \"{}\"{}", word, DidYouMean(word, candidates));
}

}  // namespace

Result<WorkerCommandLine> ParseWorkerCommandLine(const std::vector<std::string>& arguments) {
  CLI::App app("tessera-worker renders for a Tessera farm.", "tessera-worker");
  Words words;
  words.coordinator = Environment("TESSERA_COORDINATOR");
  app.allow_extras();
  app.set_version_flag("--version", std::string(kSoftwareVersion));
  app.add_option("--coordinator", words.coordinator,
                 "HOST:PORT or unix:PATH [default: $TESSERA_COORDINATOR]");
  app.add_option("--threads", words.threads, "render threads [default: all processors]");
  app.add_option("--cache-dir", words.cache_dir, "where scene files are kept [default: ~/.cache/tessera]");
  app.add_option("--cache-size", words.cache_size,
                 "bytes kept there at most; K, M, G, T may follow [default: 20G]");
  app.add_option("--name", words.name, "what people call this worker [default: the host's name]");
  app.add_option("--log-level", words.log_level, "how much goes to stderr; debug tells of every unit")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}))
      ->capture_default_str();
  app.add_option("--tag", words.tags, "a word for what this worker has: jobs may require it; may be repeated")
      ->allow_extra_args(false);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // CLI11 takes them from the back
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    return WorkerCommandLine{{}, app.help()};
  } catch (const CLI::CallForVersion&) {
    return WorkerCommandLine{{}, fmt::format("tessera-worker {}\n", kSoftwareVersion)};
  } catch (const CLI::ParseError& e) {
    return BadInput(e.what());
  }
  if (const std::string unknown = UnknownFlag(app); !unknown.empty()) return BadInput(unknown);
  auto options = Check(words);
  if (!options) return options.error();
  return WorkerCommandLine{std::move(*options), {}};
}

}  // namespace tessera
