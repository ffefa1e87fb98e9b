// Blobs that web pages send.
#pragma once

#include <memory>

#include "coordinator/access.h"
#include "coordinator/blob_service.h"
#include "coordinator/task_pool.h"
#include "coordinator/web/http_response.h"
#include "proto/blobs/blob_store.h"

namespace tessera {

// All must outlive the uploads.
struct WebUploadParts {
  const BlobStore& blobs;
  FileThreads& threads;
  TransferLoad& load;
};

// Receives a blob of `size` bytes from `offset` on, as Blobs.Upload does: with the same limits, the same
// rules for what was cut short, and an entry in the audit log.
std::shared_ptr<BodySink> MakeWebUpload(const WebUploadParts& parts, Principal caller, const Digest& digest,
                                        uint64_t size, uint64_t offset);

}  // namespace tessera
