// Whether a submitted job can be rendered with the blobs that are there.
#pragma once

#include "proto/blobs/blob_store.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

// kBadInput for a package that does not hold the job's scene files, kFailed for blobs that are missing: the
// message names the first file.
Result<void> CheckSubmission(const JobSpec& spec, const BlobStore& blobs);

}  // namespace tessera
