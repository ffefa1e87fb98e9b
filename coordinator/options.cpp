#include "coordinator/options.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "coordinator/core/membership_ledger.h"
#include "proto/shell/values.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

constexpr int kListenMax = 16;
constexpr int kAttemptsMax = 100;
constexpr int kHttpNamesMax = 16;
constexpr int kNamesForOthersMax = 32;
constexpr int kStartTokensMax = 4;  // one for each role

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

Result<Address> ParseWebAddress(const std::string& text, const char* flag) {
  auto address = ParseAddress(text, flag);
  if (!address) return address.error();
  if (address->kind != Address::Kind::kTcp)
    return BadInput(fmt::format("{} {}: must be HOST:PORT, since browsers cannot use a socket", flag, text));
  return address;
}

// An address that other machines can reach is encrypted under either flag.
Result<void> SetWebAddresses(const std::string& http, const std::string& https, CoordinatorOptions& options) {
  for (const auto& [flag, text] : {std::pair("--http", http), std::pair("--https", https)}) {
    if (text.empty()) continue;
    auto address = ParseWebAddress(text, flag);
    if (!address) return address.error();
    const bool is_plain = flag == std::string_view("--http") && address->IsLocal();
    if (!is_plain && options.insecure) {
      return BadInput(fmt::format(
          "{} {}: needs the certificates that --insecure turns off; use --http with an address of this "
          "machine alone, such as 127.0.0.1",
          flag, text));
    }
    std::optional<Address>& place = is_plain ? options.http : options.https;
    if (place) return BadInput(fmt::format("--https {}: --http has an encrypted address already", text));
    place = std::move(*address);
  }
  return {};
}

// ROLE or ROLE:USES.
Result<StartToken> ParseStartToken(const std::string& word) {
  const size_t colon = word.find(':');
  const auto role = FindRole(word.substr(0, colon));
  if (!role)
    return BadInput(
        fmt::format("--token {}: expected worker, user, viewer or operator, and perhaps :USES", word));
  if (colon == std::string::npos) return StartToken{*role};
  const auto uses = ParseInteger("--token " + word, word.substr(colon + 1), 1, kTokenUsesMax);
  if (!uses) return uses.error();
  return StartToken{*role, static_cast<int>(*uses)};
}

// The words of addresses: they can be checked once --insecure is known.
struct AddressWords {
  std::vector<std::string> listen;
  std::string http, https;
};

void AddMembershipFlags(CLI::App& app, CoordinatorOptions& options) {
  AddText(app, "--tls-cert", "FILE",
          "Certificate of an organisation for this coordinator, and those that issued it (PEM); read again "
          "when it changes",
          options.tls.certificate);
  AddText(app, "--tls-key", "FILE", "Key of that certificate (PEM)", options.tls.key);
  AddText(
      app, "--tls-ca", "FILE",
      "Also accept members whose certificates were issued by these (PEM) and name them: tessera:ROLE/NAME",
      options.tls.authority);
  AddRepeatedWord(
      app, "--token", "ROLE[:USES]",
      "Make a token that is valid for an hour and print it, as \"tessera-coordinator token\" does; "
      "may be repeated",
      kStartTokensMax, [&options](const std::string& word) -> Result<void> {
        const auto token = ParseStartToken(word);
        if (!token) return token.error();
        options.tokens.push_back(*token);
        return {};
      });
}

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
  AddMembershipFlags(app, options);
  AddText(app, "--http", "HOST:PORT",
          "Serve the live page at / and Prometheus metrics at /metrics: without encryption on an address of "
          "this machine alone, such as 127.0.0.1, as --https on others",
          words.http);
  AddText(app, "--https", "HOST:PORT",
          "Serve page and metrics over TLS, to members of the farm and to browsers that log in with a token",
          words.https);
  AddRepeatedWord(app, "--http-name", "NAME",
                  "Also serve the page under this host name, beside localhost and numeric addresses or "
                  "the names of the certificate; may be repeated",
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
             WithDefault("Number of workers that may fail a unit before its frame fails",
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
  if (auto set = SetWebAddresses(words.http, words.https, options); !set) return set.error();
  if (options.data_dir.empty()) return BadInput("--data-dir: must not be empty");
  const bool is_encrypted = !options.insecure && std::ranges::any_of(options.listen, [](const Address& each) {
    return each.kind == Address::Kind::kTcp;
  });
  if (options.tls.certificate.empty() != options.tls.key.empty())
    return BadInput("--tls-cert and --tls-key belong together: give both");
  if (!options.tls.authority.empty() && options.tls.key.empty())
    return BadInput("--tls-ca: clients of the organisation need a coordinator with --tls-cert and --tls-key");
  if (options.tls.IsUsed() && !is_encrypted && !options.https)
    return BadInput("--tls-cert: no connection is encrypted; listen on HOST:PORT, and leave out --insecure");
  if (!options.tokens.empty() && !is_encrypted) {
    return BadInput(
        "--token: others cannot join this coordinator; listen on HOST:PORT, and leave out --insecure");
  }
  return options;
}

}  // namespace

std::string CoordinatorOptions::Text() const {
  std::string text =
      fmt::format("data_dir={} blobs_size={} sums_size={} attempts_max={} insecure={} exit_with_parent={}",
                  LogText(data_dir), blob_bytes, keep_sums_bytes, attempts_max, insecure, exit_with_parent);
  for (const Address& address : listen) text += fmt::format(" listen={}", address.Text());
  if (http) text += fmt::format(" http={}", http->Text());
  if (https) text += fmt::format(" https={}", https->Text());
  if (tls.IsUsed())
    text += fmt::format(" tls_cert={} tls_ca={}", LogText(tls.certificate), LogText(tls.authority));
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
