#include "proto/identity/login.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "proto/identity/private_file.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

constexpr size_t kFarmNameMax = 64;
constexpr size_t kLineMax = 1024;
constexpr const char* kDefaultFile = "/default";

// The first line of a small file.
std::optional<std::string> ReadLine(const std::string& path) {
  auto text = ReadFile(path, kLineMax);
  if (!text) return std::nullopt;
  text->resize(std::min(text->size(), text->find('\n')));
  return std::move(*text);
}

std::string HomeFolder(const ReadVariable& environment, const char* variable, const char* below_home) {
  if (const std::string folder = environment(variable); !folder.empty()) return folder;
  if (const std::string home = environment("HOME"); !home.empty()) return home + below_home;
  return fmt::format("/var/tmp/tessera-{}", ::geteuid());
}

}  // namespace

bool IsFarmName(const std::string& name) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  return !name.empty() && name.size() <= kFarmNameMax && name.front() != '.' &&
         name.find_first_not_of(kAllowed) == std::string::npos;
}

std::string FarmNameFor(std::string address) {
  for (char& each : address) {
    if (each != '.' && !IsFarmName(std::string(1, each))) each = '-';
  }
  address.erase(0, address.find_first_not_of("-."));
  return IsFarmName(address) ? address : "farm";
}

Result<Login> LoginStore::Save(const std::string& farm, const std::string& address,
                               const IssuedIdentity& identity) const {
  if (!IsFarmName(farm)) {
    return BadInput(
        fmt::format("\"{}\" cannot be the name of a farm: use letters, digits and \". _ -\", at most {}",
                    farm, kFarmNameMax));
  }
  const Login login{farm, folder_ + "/" + farm, address};
  for (const std::string& folder : {folder_, login.folder}) {
    if (auto made = PreparePrivateFolder(folder); !made) return made.error();
  }
  // The identity comes last: without it there is no login.
  const std::pair<std::string, std::string> files[] = {
      {login.AuthorityPath(), identity.authority_pem},
      {login.AddressPath(), address + "\n"},
      {login.IdentityPath(), identity.key.Pem() + identity.certificate_pem},
      {folder_ + kDefaultFile, farm + "\n"},
  };
  for (const auto& [path, bytes] : files) {
    if (auto written = WritePrivateFile(path, bytes); !written) return written.error();
  }
  return login;
}

Result<void> LoginStore::Remove(const Login& login) const {
  std::vector<std::string> paths = {login.IdentityPath(), login.AddressPath(), login.AuthorityPath()};
  if (ReadLine(folder_ + kDefaultFile) == login.farm) paths.push_back(folder_ + kDefaultFile);
  for (const std::string& path : paths) {
    if (::unlink(path.c_str()) != 0 && errno != ENOENT)
      return Failed(fmt::format("cannot delete {}: {}", path, std::strerror(errno)));
  }
  ::rmdir(login.folder.c_str());  // fails if it holds files of somebody else, which stay
  return {};
}

std::optional<Login> LoginStore::Find(const std::string& farm) const {
  if (!IsFarmName(farm)) return std::nullopt;
  Login login{farm, folder_ + "/" + farm, {}};
  auto address = ReadLine(login.AddressPath());
  if (!address || ::access(login.IdentityPath().c_str(), F_OK) != 0) return std::nullopt;
  login.address = std::move(*address);
  return login;
}

std::vector<Login> LoginStore::List() const {
  std::vector<Login> logins;
  const auto paths = ListFolder(folder_);
  for (const std::string& path : paths ? *paths : std::vector<std::string>()) {
    if (auto login = Find(std::filesystem::path(path).filename().string()))
      logins.push_back(std::move(*login));
  }
  std::ranges::sort(logins, {}, &Login::farm);
  return logins;
}

std::optional<Login> LoginStore::Default() const {
  const auto farm = ReadLine(folder_ + kDefaultFile);
  return farm ? Find(*farm) : std::nullopt;
}

std::optional<Login> LoginStore::FindAddress(const std::string& address) const {
  if (auto preferred = Default(); preferred && preferred->address == address) return preferred;
  const std::vector<Login> logins = List();
  const auto found = std::ranges::find(logins, address, &Login::address);
  return found != logins.end() ? std::optional(*found) : std::nullopt;
}

Result<Certificate> ReadIdentity(const Login& login) {
  const auto pem = ReadPrivateFile(login.IdentityPath());
  if (!pem) return pem.error();
  const auto key = PrivateKey::FromPem(*pem, login.IdentityPath());
  if (!key) return key.error();
  auto certificate = Certificate::FromPem(*pem, login.IdentityPath());
  if (!certificate) return certificate.error();
  if (certificate->KeyDigest() != key->PublicDigest())
    return Failed(fmt::format("{}: the key does not belong to the certificate", login.IdentityPath()));
  return certificate;
}

std::string PersonalLoginFolder(const ReadVariable& environment) {
  return HomeFolder(environment, "XDG_CONFIG_HOME", "/.config") + "/tessera/farms";
}

std::string WorkerLoginFolder(const ReadVariable& environment) {
  if (const std::string state = environment("STATE_DIRECTORY"); !state.empty())
    return state.substr(0, state.find(':')) + "/farms";
  return HomeFolder(environment, "XDG_STATE_HOME", "/.local/state") + "/tessera/worker/farms";
}

}  // namespace tessera
