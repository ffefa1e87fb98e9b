#include "worker/farm_login.h"

#include <spdlog/spdlog.h>

#include <filesystem>

#include "proto/identity/private_file.h"
#include "proto/shell/console.h"
#include "proto/shell/pause.h"
#include "proto/shell/program.h"
#include "proto/wire/local_socket.h"
#include "proto/wire/membership_calls.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Certificates live for months.
constexpr std::chrono::hours kRenewalInterval{1};

// A service restarts with the same command line, so a token that made this login is not used again.
std::string TokenFile(const Login& login) {
  return login.folder + "/token";
}

bool WasJoinedWith(const Login& login, const JoinToken& token) {
  const auto used = ReadPrivateFile(TokenFile(login));
  return used && *used == token.Key().PublicDigest().Hex() && ReadIdentity(login);
}

Result<Login> Join(const JoinToken& token, const LoginStore& store, const std::string& name) {
  if (auto known = store.FindAddress(token.address); known && WasJoinedWith(*known, token)) return *known;
  const auto joined = JoinFarm(token, name);
  if (!joined) return joined.error();
  auto login = store.Save(FarmNameFor(token.address), token.address, joined->identity);
  if (!login) return login;
  if (auto written = WritePrivateFile(TokenFile(*login), token.Key().PublicDigest().Hex()); !written)
    return written.error();
  spdlog::info("joined address={} role={} name={} login={}", token.address, RoleName(joined->role),
               LogText(joined->name), LogText(login->folder));
  return login;
}

}  // namespace

Result<Endpoint> ReachFarm(const WorkerOptions& options) {
  const LoginStore store(options.state_dir);
  if (options.join && options.tls.IsUsed())
    return BadInput(
        "--join is for workers without a certificate of an organisation: leave it or --tls-cert out");
  if (options.join) {
    const auto login = Join(*options.join, store, options.name);
    if (!login) return login.error();
    return EndpointOf(*login);
  }
  if (options.coordinator) {
    return ChooseEndpoint(*options.coordinator, {options.insecure, store, LocalSocketFolder(Environment),
                                                 "start this worker once with --join TOKEN", options.tls});
  }
  if (options.tls.IsUsed()) return BadInput("--tls-cert: --coordinator HOST:PORT is required");
  const auto last = store.Default();
  if (!last) {
    return BadInput(
        "--coordinator HOST:PORT or unix:PATH is required, or --join TOKEN to become a member of a farm on "
        "other "
        "machines");
  }
  return EndpointOf(*last);
}

void KeepLoginRenewed(const Login& login, const std::shared_ptr<grpc::Channel>& channel,
                      std::stop_token stop) {
  do {
    const auto renewed = RenewIfDue(login, channel);
    if (!renewed) {
      spdlog::warn("certificate_not_renewed reason={}", LogText(renewed.error().message));
    } else if (*renewed) {
      spdlog::info("certificate_renewed login={}", LogText(login.folder));
    }
  } while (Pause(stop, kRenewalInterval));
}

}  // namespace tessera
