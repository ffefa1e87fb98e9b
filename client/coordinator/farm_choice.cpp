#include "client/coordinator/farm_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pwd.h>
#include <unistd.h>

#include "proto/identity/join_token.h"
#include "proto/identity/subject.h"
#include "proto/shell/program.h"
#include "proto/wire/local_socket.h"
#include "proto/wire/membership_calls.h"

namespace tessera {
namespace {

LoginStore PersonalLogins() {
  return LoginStore(PersonalLoginFolder(Environment));
}

// The names of its logins.
std::vector<std::string> FarmsOf(const LoginStore& store) {
  std::vector<std::string> farms;
  for (const Login& each : store.List()) farms.push_back(each.farm);
  return farms;
}

// "there are: home, studio"
std::string ListOf(const std::vector<std::string>& farms) {
  return farms.empty() ? "there is none at all" : fmt::format("there are: {}", fmt::join(farms, ", "));
}

Error NoSuchLogin(const std::string& farm, const LoginStore& store) {
  return BadInput(
      fmt::format("--farm {}: there is no login of this name ({}); run: tessera login TOKEN --farm {}", farm,
                  ListOf(FarmsOf(store)), farm));
}

std::string AccountName() {
  const passwd* const account = ::getpwuid(::geteuid());
  return account != nullptr ? account->pw_name : "";
}

}  // namespace

Result<Endpoint> ChooseFarm(const FarmChoice& choice) {
  const LoginStore store = PersonalLogins();
  const bool has_certificates = choice.tls.IsUsed();
  if (!choice.farm.empty() && !has_certificates) {
    const auto login = store.Find(choice.farm);
    if (!login) return NoSuchLogin(choice.farm, store);
    return EndpointOf(*login);
  }
  if (choice.coordinator.empty() && !choice.insecure && !has_certificates) {
    if (const auto last = store.Default()) return EndpointOf(*last);
  }
  const auto address =
      ParseAddress(choice.coordinator.empty() ? kCoordinatorDefault : choice.coordinator, "--coordinator");
  if (!address) return address.error();
  return ChooseEndpoint(*address, {choice.insecure, store, LocalSocketFolder(Environment),
                                   "run: tessera login TOKEN", choice.tls});
}

Result<MemberId> MemberOf(const Endpoint& endpoint) {
  std::string uri;
  if (endpoint.login) {
    const auto certificate = ReadIdentity(*endpoint.login);
    if (!certificate) return certificate.error();
    uri = certificate->Uri();
  } else if (endpoint.organisation) {
    const auto identity = ReadTlsIdentity(*endpoint.organisation, CertificatePurpose::kClient, UnixNow());
    if (!identity) return identity.error();
    uri = identity->chain.front().Uri();
  }
  const auto subject = Subject::Parse(uri);
  return subject ? subject->id : MemberId{};
}

Result<NewLogin> LogIn(const std::string& token, const std::string& farm, const std::string& name) {
  const auto parsed = JoinToken::Parse(token);
  if (!parsed) return parsed.error();
  const auto joined = JoinFarm(*parsed, name.empty() ? AccountName() : name);
  if (!joined) return joined.error();
  auto login = PersonalLogins().Save(farm.empty() ? FarmNameFor(parsed->address) : farm, parsed->address,
                                     joined->identity);
  if (!login) return login.error();
  return NewLogin{std::move(*login), fmt::format("{} \"{}\"", RoleName(joined->role), joined->name)};
}

Result<EndedLogin> LogOut(const std::string& farm) {
  const LoginStore store = PersonalLogins();
  const auto login = farm.empty() ? store.Default() : store.Find(farm);
  if (!login) {
    const std::string farms = ListOf(FarmsOf(store));
    if (farm.empty()) return BadInput(fmt::format("FARM: there is no last login; name the farm ({})", farms));
    return BadInput(fmt::format("FARM {}: there is no login of this name ({})", farm, farms));
  }
  if (auto removed = store.Remove(*login); !removed) return removed.error();
  return EndedLogin{*login, FarmsOf(store), store.Default().has_value()};
}

}  // namespace tessera
