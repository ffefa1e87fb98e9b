// Which blobs a client has to send.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <vector>

#include "proto/blobs/blob_store.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

// How long one call may check files. Clients try again: what was checked is not checked again.
constexpr std::chrono::seconds kFileChecksMax{10};

// Whether FindMissing reads no blob to answer.
bool IsQuickToFind(const BlobStore& blobs, const std::vector<Digest>& digests);

// Those that are not there or corrupt, each with the number of its first bytes that an upload that was cut
// short has left. An error if checking the others takes longer than kFileChecksMax.
Result<std::map<Digest, uint64_t>> FindMissing(const BlobStore& blobs, const std::vector<Digest>& digests);

}  // namespace tessera
