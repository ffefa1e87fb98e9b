#include "client/temporary_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace tessera {
namespace {

constexpr size_t kParentSizeMax = 60;  // bytes: leaves room for a socket's path, which has at most 107

}  // namespace

Result<TemporaryFolder> TemporaryFolder::Make() {
  const char* set = std::getenv("TMPDIR");
  const bool usable = set != nullptr && *set == '/' && std::strlen(set) <= kParentSizeMax;
  std::string path = fmt::format("{}/tessera-XXXXXX", usable ? set : "/tmp");
  if (::mkdtemp(path.data()) == nullptr) {
    return Failed(fmt::format("{}: a temporary folder cannot be made: {}", path, std::strerror(errno)));
  }
  return TemporaryFolder(std::move(path));
}

}  // namespace tessera
