#include "coordinator/missing_blobs.h"

#include <algorithm>

namespace tessera {

bool IsQuickToFind(const BlobStore& blobs, const std::vector<Digest>& digests) {
  return std::ranges::all_of(
      digests, [&](const Digest& digest) { return blobs.Look(digest) != BlobStore::Presence::kUnknown; });
}

Result<std::map<Digest, uint64_t>> FindMissing(const BlobStore& blobs, const std::vector<Digest>& digests) {
  const auto deadline = std::chrono::steady_clock::now() + kFileChecksMax;
  std::map<Digest, uint64_t> missing;
  for (const Digest& digest : digests) {
    if (std::chrono::steady_clock::now() > deadline)
      return Failed("the coordinator is still checking the files that it has");
    if (!blobs.UseVerified(digest)) missing.emplace(digest, blobs.Arrived(digest));
  }
  return missing;
}

}  // namespace tessera
