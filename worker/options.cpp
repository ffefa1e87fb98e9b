#include "worker/options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "proto/identity/login.h"
#include "proto/shell/program.h"
#include "proto/shell/secret_words.h"
#include "proto/shell/values.h"
#include "proto/terms.h"
#include "renderer/util/cores.h"
#include "worker/cache_folder.h"

namespace tessera {
namespace {

std::string HostName() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return *name != '\0' ? name : "worker";
}

Result<void> AddTag(std::set<std::string>& tags, const std::string& word) {
  auto tag = ParseTag("--tag", word);
  if (!tag) return tag.error();
  tags.insert(std::move(*tag));
  return {};
}

Result<void> SetSceneMemory(uint64_t& memory_bytes, const std::string& word) {
  const auto size = ParseSize("--scene-memory", word, kSceneMemoryMin);
  if (!size) return size.error();
  memory_bytes = *size;
  return {};
}

Result<void> SetToken(WorkerOptions& options, const std::string& source, const std::string& word,
                      const std::stop_token& termination) {
  const auto text = WordOrInput(word, termination);
  if (!text) return Error{text.error().kind, source + ": " + text.error().message};
  auto token = JoinToken::Parse(*text);
  if (!token) return BadInput(source + ": " + token.error().message);
  options.join = std::move(*token);
  return {};
}

Result<void> SetLoadTime(std::chrono::seconds& time, const std::string& word) {
  const auto seconds = ParseInteger("--load-timeout", word, 1, std::chrono::seconds(kLoadTimeMax).count());
  if (!seconds) return seconds.error();
  time = std::chrono::seconds(*seconds);
  return {};
}

// What is checked when all flags are known.
struct FlagWords {
  std::string coordinator, join;
};

void AddFlags(CLI::App& app, WorkerOptions& options, FlagWords& words) {
  AddText(app, "--coordinator", "ADDR",
          WithDefault("Address of the coordinator: HOST:PORT or unix:PATH", "$TESSERA_COORDINATOR"),
          words.coordinator);
  AddText(app, "--join", "TOKEN",
          WithDefault(
              "Join the farm of this token, unless this worker has done so before (see tessera-coordinator "
              "token); -: read it from standard input",
              "$TESSERA_JOIN_TOKEN"),
          words.join);
  AddText(app, "--state-dir", "DIR",
          WithDefault("Folder of the keys and certificates of this worker",
                      "~/.local/state/tessera/worker/farms"),
          options.state_dir);
  AddText(
      app, "--tls-cert", "FILE",
      WithDefault("Use this certificate of an organisation in place of joining; needs --tls-key and --tls-ca",
                  "$TESSERA_TLS_CERT"),
      options.tls.certificate);
  AddText(app, "--tls-key", "FILE", WithDefault("Key of that certificate", "$TESSERA_TLS_KEY"),
          options.tls.key);
  AddText(app, "--tls-ca", "FILE",
          WithDefault("Certificates that the coordinator's must be issued by", "$TESSERA_TLS_CA"),
          options.tls.authority);
  AddSwitch(app, "--insecure", "Connect without encryption, to a coordinator on this machine alone",
            options.insecure);
  AddInteger(app, "--threads", WithDefault("Number of render threads", "all processors"), 1, kSlotsMax,
             options.threads);
  AddText(app, "--cache-dir", "DIR", WithDefault("Folder of cached scene files", "~/.cache/tessera"),
          options.cache_dir);
  AddSize(app, "--cache-size", "Size limit of the cache; least recently used files are evicted first",
          kCacheBytesMin, options.cache_bytes);
  AddText(app, "--probe-dir", "DIR",
          "Note in this folder that this program has passed the probe, and do not render it again until the "
          "program, a library or the processor changes or the machine is restarted",
          options.probe_dir);
  AddWord(
      app, "--scene-memory", "SIZE",
      WithDefault("Memory that loading one scene may take; a scene that needs more fails",
                  "half of the memory of the machine or its control group"),
      [&options](const std::string& word) { return SetSceneMemory(options.load_limits.memory_bytes, word); });
  AddWord(app, "--load-timeout", "SECONDS",
          WithDefault("Time that loading one scene may take; a scene that needs more fails",
                      std::to_string(kLoadTimeDefault.count())),
          [&options](const std::string& word) { return SetLoadTime(options.load_limits.time, word); });
  AddText(app, "--name", "NAME", WithDefault("Name of this worker in lists and messages", "the host name"),
          options.name);
  AddRepeatedWord(app, "--tag", "TAG", "Offer this tag to jobs that require it; may be repeated",
                  static_cast<int>(kTagsMax),
                  [&options](const std::string& word) { return AddTag(options.tags, word); });
  AddLogLevel(app, options.log_level);
}

// Certificates of an organisation come before a token, as flags and in the environment.
Result<void> AddEnvironment(WorkerOptions& options, const std::stop_token& termination) {
  if (options.join || options.tls.IsUsed()) return {};
  options.tls = {Environment("TESSERA_TLS_CERT"), Environment("TESSERA_TLS_KEY"),
                 Environment("TESSERA_TLS_CA")};
  const std::string token = Environment("TESSERA_JOIN_TOKEN");
  if (token.empty() || options.tls.IsUsed() || options.insecure) return {};
  return SetToken(options, "$TESSERA_JOIN_TOKEN", token, termination);
}

Result<WorkerOptions> Complete(WorkerOptions options, const FlagWords& words,
                               const std::stop_token& termination) {
  if (!words.join.empty()) {
    if (auto set = SetToken(options, "--join", words.join, termination); !set) return set.error();
  }
  if (auto added = AddEnvironment(options, termination); !added) return added.error();
  // A token names its coordinator, whatever the environment says.
  const std::string text = options.join ? options.join->address : words.coordinator;
  if (!text.empty()) {
    auto address = ParseAddress(text, "--coordinator");
    if (!address) return address.error();
    options.coordinator = std::move(*address);
  }
  if (options.state_dir.empty()) options.state_dir = WorkerLoginFolder(Environment);
  if (options.threads == 0) options.threads = UsableCores();
  if (options.cache_dir.empty()) options.cache_dir = DefaultCacheFolder(Environment);
  if (options.name.empty()) options.name = HostName();
  return options;
}

}  // namespace

Result<CommandLineOf<WorkerOptions>> ParseWorkerCommandLine(const std::vector<std::string>& arguments,
                                                            const std::stop_token& termination) {
  CLI::App app("Render for a Tessera farm.", "tessera-worker");
  WorkerOptions options;
  options.load_limits.memory_bytes = DefaultSceneMemory();
  FlagWords words{Environment("TESSERA_COORDINATOR"), {}};
  AddFlags(app, options, words);
  auto answer = ParseArguments(app, arguments);
  if (!answer) return answer.error();
  if (!answer->empty()) return CommandLineOf<WorkerOptions>{{}, std::move(*answer)};
  auto complete = Complete(std::move(options), words, termination);
  if (!complete) return complete.error();
  return CommandLineOf<WorkerOptions>{std::move(*complete), {}};
}

}  // namespace tessera
