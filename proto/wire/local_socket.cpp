#include "proto/wire/local_socket.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "proto/identity/private_file.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

bool IsWildcard(const std::string& host) {
  return host == "0.0.0.0" || host == "::";
}

constexpr const char* kSocketEnding = ".socket";

// Whether the kernel knows that nobody listens on the socket. A listener that is only busy is one.
bool IsDeserted(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof name.sun_path) return false;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return false;
  const bool is_refused =
      ::connect(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name) != 0 && errno == ECONNREFUSED;
  ::close(socket);
  return is_refused;
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

SocketFolderLock::SocketFolderLock(const std::string& folder)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ >= 0) ::flock(folder_, LOCK_EX);
}

SocketFolderLock::~SocketFolderLock() {
  if (folder_ >= 0) ::close(folder_);
}

int RemoveStaleSockets(const std::string& folder) {
  int removed = 0;
  const auto paths = ListFolder(folder);
  for (const std::string& path : paths ? *paths : std::vector<std::string>()) {
    struct stat status {};
    if (std::filesystem::path(path).extension() != kSocketEnding || ::lstat(path.c_str(), &status) != 0)
      continue;
    const bool is_ours = S_ISSOCK(status.st_mode) && status.st_uid == ::geteuid();
    if (is_ours && IsDeserted(path) && ::unlink(path.c_str()) == 0) ++removed;
  }
  return removed;
}

bool IsListening(const Address& socket) {
  struct stat status {};
  return ::lstat(socket.path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode) &&
         status.st_uid == ::geteuid() && !IsDeserted(socket.path);
}

std::optional<Address> LocalSocketOf(const Address& address, const std::string& folder) {
  if (address.kind != Address::Kind::kTcp) return std::nullopt;
  std::string host = address.host;
  if (host == "localhost" || IsWildcard(host)) host = "127.0.0.1";
  // Brackets and colons mean something in gRPC's names.
  std::ranges::replace_if(
      host, [](char each) { return std::isalnum(static_cast<unsigned char>(each)) == 0 && each != '.'; },
      '_');
  auto socket =
      ParseAddress(fmt::format("unix:{}/{}-{}{}", folder, host, address.port, kSocketEnding), "local socket");
  return socket ? std::optional(std::move(*socket)) : std::nullopt;
}

}  // namespace tessera
