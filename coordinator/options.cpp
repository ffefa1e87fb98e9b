#include "coordinator/options.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr int kListenMax = 16;
constexpr int kAttemptsMax = 100;
constexpr int kHttpNamesMax = 16;
constexpr int kNamesForOthersMax = 32;

Result<Address> ParseListenAddress(const std::string& text, bool insecure) {
  auto address = ParseAddress(text, "--listen");
  if (!address) return address.error();
  if (insecure && !address->IsLocal()) {
    return BadInput(
        fmt::format("--listen {}: other machines could reach this address, and --insecure is for addresses "
                    "of this machine "
                    "alone, such as 127.0.0.1; leave it out to encrypt connections",
                    text));
  }
  return address;
}

Result<Address> ParseHttpAddress(const std::string& text) {
  auto address = ParseAddress(text, "--http");
  if (!address) return address.error();
  if (address->kind != Address::Kind::kTcp)
    return BadInput(fmt::format("--http {}: must be HOST:PORT, since browsers cannot use a socket", text));
  if (!address->IsLocal()) {
    return BadInput(fmt::format(
        "--http {}: other machines could reach this address, and the page is not encrypted; use 127.0.0.1",
        text));
  }
  return address;
}

// The words of addresses: they can be checked once --insecure is known.
struct AddressWords {
  std::vector<std::string> listen;
  std::string http;
};

void AddFlags(CLI::App& app, CoordinatorOptions& options, AddressWords& words) {
  AddRepeatedWord(
      app, "--listen", "ADDR", "Address for clients and workers: HOST:PORT or unix:PATH; may be repeated",
      kListenMax,
      [&words](const std::string& word) -> Result<void> {
        words.listen.push_back(word);
        return {};
      },
      Presence::kRequired);
  AddText(app, "--data-dir", "DIR", "Folder of everything that survives a restart", options.data_dir,
          Presence::kRequired);
  AddRepeatedWord(app, "--name-or-address", "NAME",
                  WithDefault("Host name or address under which others reach this coordinator, for its "
                              "certificate; may be repeated",
                              "those of this machine"),
                  kNamesForOthersMax, [&options](const std::string& word) -> Result<void> {
                    options.names.push_back(word);
                    return {};
                  });
  AddText(app, "--http", "HOST:PORT", "Serve a status page at / and Prometheus metrics at /metrics",
          words.http);
  AddRepeatedWord(app, "--http-name", "NAME",
                  "Also serve the status page under this host name, beside localhost and numeric addresses; "
                  "may be repeated",
                  kHttpNamesMax, [&options](const std::string& word) -> Result<void> {
                    options.http_names.push_back(word);
                    return {};
                  });
  AddSize(app, "--blobs-size,--blob-bytes",
          "Size limit of the scene files kept; least recently used files are evicted first", kBlobBytesMin,
          options.blob_bytes);
  AddSize(app, "--sums-size,--keep-sums",
          "Size limit of the sums kept of finished frames, which tessera extend needs, and damaged pictures "
          "to be "
          "made again; the oldest are evicted first, 0 keeps none",
          0, options.keep_sums_bytes);
  AddInteger(app, "--attempts-max",
             WithDefault("Number of workers that may fail a unit before its job fails",
                         fmt::format("{}", options.attempts_max)),
             1, kAttemptsMax, options.attempts_max);
  AddSwitch(app, "--insecure", "Use neither encryption nor logins, on addresses of this machine alone",
            options.insecure);
  AddSwitch(app, "--start-afresh",
            "Accept a data directory whose journal is missing: all jobs that it had are forgotten",
            options.start_afresh);
  AddSwitch(app, "--exit-with-parent", "Exit when the parent process exits", options.exit_with_parent);
  AddLogLevel(app, options.log_level);
}

Result<CoordinatorOptions> Complete(CoordinatorOptions options, const AddressWords& words) {
  for (const std::string& text : words.listen) {
    auto address = ParseListenAddress(text, options.insecure);
    if (!address) return address.error();
    options.listen.push_back(std::move(*address));
  }
  if (!words.http.empty()) {
    auto address = ParseHttpAddress(words.http);
    if (!address) return address.error();
    options.http = std::move(*address);
  }
  if (options.data_dir.empty()) return BadInput("--data-dir: must not be empty");
  return options;
}

}  // namespace

std::string CoordinatorOptions::Text() const {
  std::string text =
      fmt::format("data_dir={} blobs_size={} sums_size={} attempts_max={} insecure={} exit_with_parent={}",
                  LogText(data_dir), blob_bytes, keep_sums_bytes, attempts_max, insecure, exit_with_parent);
  for (const Address& address : listen) text += fmt::format(" listen={}", address.Text());
  if (http) text += fmt::format(" http={}", http->Text());
  for (const std::string& name : names) text += fmt::format(" name={}", LogText(name));
  for (const std::string& name : http_names) text += fmt::format(" http_name={}", name);
  return text;
}

Result<CommandLineOf<CoordinatorOptions>> ParseCoordinatorCommandLine(
    const std::vector<std::string>& arguments) {
  CLI::App app("Lease the tiles of frames to workers and merge what they return.", "tessera-coordinator");
  CoordinatorOptions options;
  AddressWords words;
  AddFlags(app, options, words);
  app.footer(
      "\"tessera-coordinator init\" makes keys and certificates beforehand; \"tessera-coordinator token\" "
      "lets others "
      "join. Both have a --help.");
  auto answer = ParseArguments(app, arguments);
  if (!answer) return answer.error();
  if (!answer->empty()) return CommandLineOf<CoordinatorOptions>{{}, std::move(*answer)};
  auto complete = Complete(std::move(options), words);
  if (!complete) return complete.error();
  return CommandLineOf<CoordinatorOptions>{std::move(*complete), {}};
}

}  // namespace tessera
