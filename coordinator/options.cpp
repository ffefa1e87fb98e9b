#include "coordinator/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "proto/terms.h"

namespace tessera {
namespace {

constexpr int kListenMax = 16;
constexpr int kAttemptsMax = 100;

Result<Address> CheckAddress(const std::string& text, const std::string& flag, bool insecure) {
  auto address = ParseAddress(text, flag);
  if (!address) return address.error();
  if (!address->IsLocal() && !insecure) {
    return BadInput(
        fmt::format("{} {}: other machines could reach this address and nobody has to log in; listen "
                    "on 127.0.0.1{}, or say --insecure if the network is trusted",
                    flag, text, flag == "--listen" ? " or unix:PATH" : ""));
  }
  return address;
}

Result<CoordinatorOptions> Check(CoordinatorOptions options, const std::vector<std::string>& listen,
                                 const std::string& http) {
  for (const std::string& text : listen) {
    auto address = CheckAddress(text, "--listen", options.insecure);
    if (!address) return address.error();
    options.listen.push_back(std::move(*address));
  }
  if (!http.empty()) {
    auto address = CheckAddress(http, "--http", options.insecure);
    if (!address) return address.error();
    if (address->kind != Address::Kind::kTcp)
      return BadInput(fmt::format("--http {}: browsers need HOST:PORT", http));
    options.http = std::move(*address);
  }
  if (options.blob_bytes < kBlobBytesMin) return BadInput("--blob-bytes: at least 1M");
  if (options.data_dir.empty()) return BadInput("--data-dir: is empty");
  return options;
}

}  // namespace

std::string CoordinatorOptions::Text() const {
  std::string text = fmt::format("data_dir=\"{}\" blob_bytes={} insecure={} exit_with_parent={} keep_sums={}",
                                 data_dir, blob_bytes, insecure, exit_with_parent, keep_sums_bytes);
  for (const Address& address : listen) text += fmt::format(" listen={}", address.Text());
  if (http) text += fmt::format(" http={}", http->Text());
  return text;
}

Result<std::optional<CoordinatorOptions>> ParseCoordinatorOptions(int argc, char** argv) {
  CLI::App app("Leases the tiles of frames to tessera-workers and merges what they return.",
               "tessera-coordinator");
  app.set_version_flag("--version", std::string("tessera-coordinator ") + kSoftwareVersion);
  CoordinatorOptions options;
  std::vector<std::string> listen;
  std::string http;
  app.add_option("--listen", listen,
                 "where clients and workers connect: HOST:PORT or unix:PATH; may be repeated")
      ->required()
      ->expected(1, kListenMax)
      ->allow_extra_args(false);
  app.add_option("--data-dir", options.data_dir, "folder for everything that outlives this process")
      ->required();
  app.add_option("--http", http,
                 "HOST:PORT of a status page for browsers, with metrics for Prometheus at /metrics");
  app.add_option("--blob-bytes", options.blob_bytes,
                 "scene files kept at most (100G); K, M, G, T may follow; the longest unused go first")
      ->transform(CLI::AsSizeValue(false));
  app.add_flag("--insecure", options.insecure, "listen on addresses that other machines can reach");
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "end when the process that started this one ends");
  app.add_option(
         "--attempts-max", options.attempts_max,
         "different workers that may fail a unit before its job fails (3); for a farm of fewer: how many")
      ->check(CLI::Range(1, kAttemptsMax));
  app.add_option(
         "--keep-sums", options.keep_sums_bytes,
         "how much of the disk the sums of finished frames may take, as 500MB or 16GB (the default), so "
         "that tessera extend has something to go on from; the oldest go first; 0: none")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  app.add_option("--log-level", options.log_level, "how much goes to stderr")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    app.exit(success);
    return std::optional<CoordinatorOptions>();
  } catch (const CLI::ParseError& error) {
    return BadInput(error.what());
  }
  auto checked = Check(std::move(options), listen, http);
  if (!checked) return checked.error();
  return std::optional(std::move(*checked));
}

}  // namespace tessera
