#include "coordinator/listener/descriptors.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "renderer/text/unicode.h"

namespace tessera {
namespace {

// Two connections of each of 10,000 workers, and some 25 KB of memory each.
constexpr rlim_t kConnectionsMax = 20'000;
// Spool segments, scene files being transferred, pictures, journal, web page. A process that may open
// few descriptors reserves a quarter of them.
constexpr rlim_t kReserve = 256;
constexpr rlim_t kReserveShare = 4;

rlim_t DescriptorLimit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
  return std::min(limit.rlim_cur, kConnectionsMax + kReserve);
}

}  // namespace

void RaiseDescriptorLimit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min(limit.rlim_max, kConnectionsMax + kReserve);
  if (limit.rlim_cur >= wanted) return;
  limit.rlim_cur = wanted;
  if (::setrlimit(RLIMIT_NOFILE, &limit) != 0)
    spdlog::warn("descriptor_limit_not_raised reason={}", LogText(std::strerror(errno)));
}

int ConnectionDescriptorsMax() {
  const rlim_t limit = DescriptorLimit();
  return static_cast<int>(limit - std::min(kReserve, limit / kReserveShare));
}

}  // namespace tessera
