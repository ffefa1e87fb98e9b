#include "coordinator/membership/farm_identity.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"

namespace tessera {
namespace {

constexpr size_t kHostNamesMax = 64;  // of one certificate; a machine has fewer interfaces
// Every coordinator is also reached under these.
const char* const kOwnNames[] = {kCoordinatorName, "localhost", "127.0.0.1", "::1"};

std::string AuthorityPath(const std::string& folder) {
  return folder + "/authority.pem";
}

Result<Authority> OpenAuthority(const std::string& path, bool& is_new, UnixTime now) {
  is_new = !std::filesystem::exists(path);
  if (is_new) {
    Authority made = Authority::Make("Tessera farm authority", now);
    if (auto written = WritePrivateFile(path, made.Pem()); !written) return written.error();
    return made;
  }
  const auto pem = ReadPrivateFile(path);
  if (!pem) return pem.error();
  return Authority::FromPem(*pem, path);
}

// Members of a farm accept its authority alone, so a farm that has some does not get another one unasked.
Result<void> CheckExpected(const std::string& folder, const ExpectedAuthority& expected) {
  if (!expected.has_members) return {};
  constexpr const char* kRemedy =
      "so its members could not connect; put the folder back, or let all of them join again with "
      "--start-afresh";
  const std::string path = AuthorityPath(folder);
  if (!std::filesystem::exists(path))
    return Failed(fmt::format("{}: the key of the farm's authority is missing, {}", folder, kRemedy));
  if (!expected.fingerprint) return {};
  const auto pem = ReadPrivateFile(path);
  if (!pem) return pem.error();
  const auto authority = Authority::FromPem(*pem, path);
  if (!authority) return authority.error();
  const Digest found = authority->certificate().Fingerprint();
  if (found == *expected.fingerprint) return {};
  return Failed(fmt::format("{}: holds the authority of another farm (fingerprint {}, this farm's is {}), {}",
                            folder, found.Hex(), expected.fingerprint->Hex(), kRemedy));
}

// Whether the certificate can be used for at least half of its life, by this authority and for these names.
bool IsUsable(const std::string& path, const Authority& authority, const std::vector<std::string>& names,
              UnixTime now) {
  const auto pem = ReadPrivateFile(path);
  const auto key = pem ? PrivateKey::FromPem(*pem, path) : Result<PrivateKey>(Failed(""));
  const auto certificate = pem ? Certificate::FromPem(*pem, path) : Result<Certificate>(Failed(""));
  if (!key || !certificate || certificate->KeyDigest() != key->PublicDigest()) return false;
  const UnixTime halftime = now + std::chrono::seconds(kCoordinatorLifetime).count() / 2;
  return certificate->HostNames() == names && certificate->NotAfter() > halftime &&
         CheckCertificate({*certificate}, {authority.certificate()}, CertificatePurpose::kServer, now) ==
             CertificateVerdict::kGood;
}

std::string AddressText(const sockaddr* address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address->sa_family == AF_INET) {
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof text);
  } else if (address->sa_family == AF_INET6) {
    ::inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text, sizeof text);
  }
  return text;
}

}  // namespace

std::vector<std::string> NamesOfThisMachine() {
  std::set<std::string> names;
  char host[256] = "";
  if (::gethostname(host, sizeof host - 1) == 0 && *host != '\0') names.insert(host);
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) == 0) {
    for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
      if (each->ifa_addr == nullptr || (each->ifa_flags & IFF_LOOPBACK) != 0) continue;
      if (const std::string text = AddressText(each->ifa_addr); !text.empty()) names.insert(text);
    }
    ::freeifaddrs(list);
  }
  return {names.begin(), names.end()};
}

bool FarmIdentity::Exists(const std::string& folder) {
  return std::filesystem::exists(AuthorityPath(folder));
}

Result<FarmIdentity> FarmIdentity::Open(const std::string& folder, std::vector<std::string> host_names,
                                        UnixTime now, const ExpectedAuthority& expected) {
  if (auto checked = CheckExpected(folder, expected); !checked) return checked.error();
  if (auto made = PreparePrivateFolder(folder); !made) return made.error();
  bool is_new = false;
  auto authority = OpenAuthority(AuthorityPath(folder), is_new, now);
  if (!authority) return authority.error();
  if (authority->certificate().NotAfter() < now) {
    return Failed(
        fmt::format("{}/authority.pem: expired on {}; move it away to make a new one, after which all "
                    "members have to join again",
                    folder, UnixTimeText(authority->certificate().NotAfter())));
  }
  std::vector<std::string> names(std::begin(kOwnNames), std::end(kOwnNames));
  for (std::string& each : host_names) {
    if (std::ranges::find(names, each) == names.end()) names.push_back(std::move(each));
  }
  if (names.size() > kHostNamesMax) names.resize(kHostNamesMax);
  FarmIdentity identity(std::move(*authority), folder + "/coordinator.pem", is_new);
  if (IsUsable(identity.coordinator_path_, identity.authority_, names, now)) return identity;
  const PrivateKey key = PrivateKey::Generate();
  CertificateTerms terms;
  terms.common_name = "Tessera coordinator";
  terms.host_names = names;
  terms.purpose = CertificatePurpose::kServer;
  terms.lifetime = kCoordinatorLifetime;
  terms.serial = static_cast<uint64_t>(now);
  const Certificate made = identity.authority_.Issue(key, terms, now);
  auto written = WritePrivateFile(identity.coordinator_path_,
                                  key.Pem() + made.Pem() + identity.authority_.certificate().Pem());
  if (!written) return written.error();
  return identity;
}

}  // namespace tessera
