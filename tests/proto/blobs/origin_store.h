// A blob store as a coordinator opens it, for tests.
#pragma once

#include <cstdint>
#include <string>

#include "proto/blobs/blob_store.h"

namespace tessera {

constexpr uint64_t kMega = uint64_t{1} << 20;  // bytes

inline Result<BlobStore> OpenOrigin(const std::string& path, uint64_t bytes_max = uint64_t{1} << 40) {
  return BlobStore::Open(path, BlobStoreOptions::Origin(bytes_max));
}

}  // namespace tessera
