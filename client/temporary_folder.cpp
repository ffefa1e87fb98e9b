#include "client/temporary_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "proto/shell/program.h"

namespace tessera {
namespace {

constexpr size_t kParentSizeMax = 60;  // bytes: the path of a socket has at most 107

}  // namespace

Result<TemporaryFolder> TemporaryFolder::Make() {
  const std::string set = Environment("TMPDIR");
  const bool usable = set.starts_with('/') && set.size() <= kParentSizeMax;
  std::string path = fmt::format("{}/tessera-XXXXXX", usable ? set : "/tmp");
  if (::mkdtemp(path.data()) == nullptr) {
    return Failed(fmt::format("{}: cannot create a temporary folder: {}", path, std::strerror(errno)));
  }
  return TemporaryFolder(std::move(path));
}

}  // namespace tessera
