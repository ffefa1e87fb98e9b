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

Result<Address> ParseLocalAddress(const std::string& flag, const std::string& text, bool insecure) {
  auto address = ParseAddress(text, flag);
  if (!address) return address.error();
  if (!address->IsLocal() && !insecure) {
    return BadInput(
        fmt::format("{} {}: other machines could reach this address and there is no login; listen on "
                    "127.0.0.1{}, or add --insecure if you trust the network",
                    flag, text, flag == "--listen" ? " or unix:PATH" : ""));
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
  AddSwitch(app, "--insecure", "Allow addresses that other machines can reach", options.insecure);
  AddSwitch(app, "--start-afresh",
            "Accept a data directory whose journal is missing: all jobs that it had are forgotten",
            options.start_afresh);
  AddSwitch(app, "--exit-with-parent", "Exit when the parent process exits", options.exit_with_parent);
  AddLogLevel(app, options.log_level);
}

Result<CoordinatorOptions> Complete(CoordinatorOptions options, const AddressWords& words) {
  for (const std::string& text : words.listen) {
    auto address = ParseLocalAddress("--listen", text, options.insecure);
    if (!address) return address.error();
    options.listen.push_back(std::move(*address));
  }
  if (!words.http.empty()) {
    auto address = ParseLocalAddress("--http", words.http, options.insecure);
    if (!address) return address.error();
    if (address->kind != Address::Kind::kTcp)
      return BadInput(
          fmt::format("--http {}: must be HOST:PORT, since browsers cannot use a socket", words.http));
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
  for (const std::string& name : http_names) text += fmt::format(" http_name={}", name);
  return text;
}

Result<CommandLineOf<CoordinatorOptions>> ParseCoordinatorCommandLine(
    const std::vector<std::string>& arguments) {
  CLI::App app("Lease the tiles of frames to workers and merge what they return.", "tessera-coordinator");
  CoordinatorOptions options;
  AddressWords words;
  AddFlags(app, options, words);
  auto answer = ParseArguments(app, arguments);
  if (!answer) return answer.error();
  if (!answer->empty()) return CommandLineOf<CoordinatorOptions>{{}, std::move(*answer)};
  auto complete = Complete(std::move(options), words);
  if (!complete) return complete.error();
  return CommandLineOf<CoordinatorOptions>{std::move(*complete), {}};
}

}  // namespace tessera
