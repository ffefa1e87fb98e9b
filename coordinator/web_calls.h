// What the web interface asks of the farm: the same calls as those of gRPC, with the same rules, audit log
// and promises of durability.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "coordinator/access.h"
#include "coordinator/blob_service.h"
#include "coordinator/call_gate.h"
#include "coordinator/job_log.h"
#include "coordinator/store/picture_store.h"
#include "coordinator/task_pool.h"
#include "coordinator/web/api/web_farm.h"
#include "proto/blobs/blob_store.h"

namespace tessera {

// All must outlive the functions.
struct WebCallParts {
  const CallGate& gate;
  const BlobStore& blobs;
  const PictureStore& pictures;
  const JobLog& job_log;
  TaskPool& background;
  FileThreads& files;
  TransferLoad& transfers;
  AccessPolicy policy;
  // Whether programs of other users of this machine may do everything, as they may with the plain port of
  // gRPC.
  bool is_insecure = false;
  std::function<std::optional<FarmView>()> view;
};

WebFarm MakeWebFarm(WebCallParts parts);

}  // namespace tessera
