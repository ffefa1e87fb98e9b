#include "proto/wire/local_socket.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "proto/identity/private_file.h"

namespace tessera {
namespace {

bool IsWildcard(const std::string& host) {
  return host == "0.0.0.0" || host == "::";
}

}  // namespace

std::string LocalSocketFolder(const ReadVariable& environment) {
  if (const std::string folder = environment("XDG_RUNTIME_DIR"); !folder.empty()) return folder + "/tessera";
  const std::string of_user = fmt::format("/run/user/{}", ::geteuid());
  struct stat status {};
  if (::stat(of_user.c_str(), &status) == 0 && status.st_uid == ::geteuid()) return of_user + "/tessera";
  const std::string temporary = environment("TMPDIR");
  return fmt::format("{}/tessera-{}", temporary.empty() ? "/tmp" : temporary, ::geteuid());
}

Result<void> PrepareLocalSocketFolder(const std::string& folder) {
  return PreparePrivateFolder(folder);
}

std::optional<Address> LocalSocketOf(const Address& address, const std::string& folder) {
  if (address.kind != Address::Kind::kTcp) return std::nullopt;
  std::string host = address.host;
  if (host == "localhost" || IsWildcard(host)) host = "127.0.0.1";
  // Brackets and colons mean something in gRPC's names.
  std::ranges::replace_if(
      host, [](char each) { return std::isalnum(static_cast<unsigned char>(each)) == 0 && each != '.'; },
      '_');
  auto socket = ParseAddress(fmt::format("unix:{}/{}-{}.socket", folder, host, address.port), "local socket");
  return socket ? std::optional(std::move(*socket)) : std::nullopt;
}

}  // namespace tessera
