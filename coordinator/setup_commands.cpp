#include "coordinator/setup_commands.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <sys/stat.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "coordinator/access_service.h"
#include "coordinator/membership/farm_identity.h"
#include "coordinator/store/data_dir.h"
#include "proto/access.grpc.pb.h"
#include "proto/identity/join_token.h"
#include "proto/identity/login.h"
#include "proto/shell/console.h"
#include "proto/shell/flags.h"
#include "proto/shell/program.h"
#include "proto/shell/values.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/wire/convert_access.h"
#include "proto/wire/endpoint.h"
#include "proto/wire/local_socket.h"
#include "proto/wire/reachability.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kTokenAnswerPatience{15};
constexpr std::chrono::hours kTokenLifetimeDefault{1};

// A duration as in "30m", "1h" or "7d"; a number alone is seconds.
Result<std::chrono::seconds> ParseLifetime(const std::string& flag, const std::string& word) {
  constexpr std::pair<char, int64_t> kUnits[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}};
  std::string digits = word;
  int64_t unit = 1;
  for (const auto& [letter, seconds] : kUnits) {
    if (!word.ends_with(letter)) continue;
    digits.pop_back();
    unit = seconds;
  }
  const int64_t max = std::chrono::seconds(kTokenLifetimeMax).count();
  const auto count = ParseInteger(flag, digits, 1, max / unit);
  if (!count)
    return BadInput(fmt::format("{} {}: expected a time such as 30m, 1h or 7d, at most 365d", flag, word));
  return std::chrono::seconds(*count * unit);
}

struct TokenOptions {
  Role role{};
  std::string name;
  std::chrono::seconds lifetime = kTokenLifetimeDefault;
  int uses = 1;
  std::string address;  // that the token names; empty: the coordinator chooses
  std::string coordinator;

  Result<Endpoint> ChooseCoordinator() const;
};

void AddTokenFlags(CLI::App& app, TokenOptions& options) {
  AddWord(
      app, "--role", "ROLE", "Role of the member that joins with the token: worker, user, viewer or operator",
      [&options](const std::string& word) -> Result<void> {
        const auto role = FindRole(word);
        if (!role) return BadInput(fmt::format("--role {}: expected worker, user, viewer or operator", word));
        options.role = *role;
        return {};
      },
      Presence::kRequired);
  AddText(app, "--name", "NAME", WithDefault("Name of the new member", "what it calls itself"), options.name);
  AddWord(app, "--ttl", "TIME", WithDefault("How long the token can be used: 30m, 1h, 7d", "1h"),
          [&options](const std::string& word) -> Result<void> {
            const auto lifetime = ParseLifetime("--ttl", word);
            if (!lifetime) return lifetime.error();
            options.lifetime = *lifetime;
            return {};
          });
  AddInteger(app, "--uses", WithDefault("Number of members that may join", "1"), 1,
             static_cast<int>(kTokenUsesMax), options.uses);
  AddText(app, "--address", "HOST:PORT",
          WithDefault("Address under which the holder reaches the coordinator", "chosen by the coordinator"),
          options.address);
  options.coordinator = Environment("TESSERA_COORDINATOR");
  AddText(app, "--coordinator", "ADDR",
          WithDefault("Coordinator to ask, one of this user or one that this user is an operator of",
                      "$TESSERA_COORDINATOR or 127.0.0.1:7700"),
          options.coordinator);
}

Result<Endpoint> TokenOptions::ChooseCoordinator() const {
  const auto address = ParseAddress(coordinator.empty() ? "127.0.0.1:7700" : coordinator, "--coordinator");
  if (!address) return address.error();
  EndpointRules rules{false, LoginStore(PersonalLoginFolder(Environment)), LocalSocketFolder(Environment),
                      "run: tessera login TOKEN"};
  rules.prefer_local_socket = true;
  return ChooseEndpoint(*address, rules);
}

Result<proto::TokenAnswer> AskForToken(const TokenOptions& options, const Endpoint& endpoint,
                                       const Digest& key) {
  const auto channel = OpenChannel(endpoint);
  proto::TokenRequest request;
  request.set_key(WriteDigest(key));
  request.set_role(WriteRole(options.role));
  request.set_name(CleanName(options.name));
  request.set_lifetime_s(static_cast<uint64_t>(options.lifetime.count()));
  request.set_uses(static_cast<uint32_t>(options.uses));
  proto::TokenAnswer answer;
  grpc::ClientContext context;
  context.set_wait_for_ready(true);
  SetDeadline(context, kTokenAnswerPatience);
  const grpc::Status status = proto::Access::NewStub(channel)->IssueToken(&context, request, &answer);
  if (status.ok()) return answer;
  if (!IsTransient(status)) return ToError(status, "make a token");
  return Failed(fmt::format("{}: cannot make a token: {}; start the coordinator first, as this user",
                            endpoint.address.Text(), DescribeOutage(CheckReachability(endpoint), status)));
}

Result<void> MakeAndPrint(const TokenOptions& options, const Endpoint& endpoint) {
  JoinToken token = JoinToken::Make("", {});
  const auto answer = AskForToken(options, endpoint, token.Key().PublicDigest());
  if (!answer) return answer.error();
  const auto authority = ReadDigest(answer->authority(), "authority");
  if (!authority) return authority.error();
  token.authority = *authority;
  token.address = options.address;
  if (token.address.empty() && answer->addresses_size() > 0) token.address = answer->addresses(0);
  const auto address = ParseAddress(token.address, "--address");
  if (!address) return address.error();
  fmt::print("{}\n", token.Text());
  std::fflush(stdout);  // a script may read it while the coordinator runs
  PrintNote("for {} {}, until {}, to join {} with: {}\n", options.uses,
            std::string(RoleName(options.role)) + (options.uses == 1 ? "" : "s"),
            UnixTimeText(answer->expires()), token.address,
            options.role == Role::kWorker ? "tessera-worker --join TOKEN" : "tessera login TOKEN");
  if (address->IsLocal()) PrintNote("only this machine can reach that address: see --listen and --address\n");
  return {};
}

Result<int> RunToken(const TokenOptions& options) {
  const auto endpoint = options.ChooseCoordinator();
  if (!endpoint) return endpoint.error();
  if (const auto made = MakeAndPrint(options, *endpoint); !made) return made.error();
  return 0;
}

struct InitOptions {
  std::string data_dir;
  std::vector<std::string> names;
};

Result<int> RunInit(const InitOptions& options) {
  ::umask(0077);
  const auto directory = DataDir::Open(options.data_dir);
  if (!directory) return directory.error();
  const auto identity = FarmIdentity::Open(
      directory->IdentityPath(), options.names.empty() ? NamesOfThisMachine() : options.names, UnixNow());
  if (!identity) return identity.error();
  fmt::print("{}\n", identity->authority().certificate().Fingerprint().Hex());
  PrintNote("{}: {}; its fingerprint is printed above\n", directory->IdentityPath(),
            identity->is_new() ? "made a certificate authority for the farm"
                               : "has a certificate authority already");
  return 0;
}

constexpr int kNamesMax = 32;

// Parses the words after the name of a command and runs it.
template <typename Options, typename AddFlags, typename Run>
Result<int> ParseAndRun(const char* name, const char* summary, const std::vector<std::string>& arguments,
                        AddFlags add_flags, Run run) {
  CLI::App app(summary, std::string("tessera-coordinator ") + name);
  Options options;
  add_flags(app, options);
  const auto answer = ParseArguments(app, {arguments.begin() + 1, arguments.end()});
  if (!answer) return answer.error();
  if (answer->empty()) return run(options);
  fmt::print("{}", *answer);
  return 0;
}

}  // namespace

Result<void> PrintStartToken(const StartToken& wish, const std::vector<Address>& addresses) {
  const std::string folder = LocalSocketFolder(Environment);
  for (const Address& address : addresses) {
    const auto socket = LocalSocketOf(address, folder);
    if (!socket) continue;
    TokenOptions options;
    options.role = wish.role;
    options.uses = wish.uses;
    return MakeAndPrint(options, Endpoint(address, *socket, std::nullopt));
  }
  return Failed("--token: the coordinator has no local socket; use tessera-coordinator token");
}

std::optional<Result<int>> RunSetupCommand(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return std::nullopt;
  if (arguments.front() == "token") {
    return ParseAndRun<TokenOptions>("token", "Make a token with which others join the farm.", arguments,
                                     AddTokenFlags, RunToken);
  }
  if (arguments.front() != "init") return std::nullopt;
  const auto add_flags = [](CLI::App& app, InitOptions& options) {
    AddText(app, "--data-dir", "DIR", "Folder of everything that survives a restart", options.data_dir,
            Presence::kRequired);
    AddRepeatedWord(app, "--name-or-address", "NAME", "As for running the coordinator; may be repeated",
                    kNamesMax, [&options](const std::string& word) -> Result<void> {
                      options.names.push_back(word);
                      return {};
                    });
  };
  return ParseAndRun<InitOptions>("init", "Make the keys and certificates of a farm, without starting it.",
                                  arguments, add_flags, RunInit);
}

}  // namespace tessera
