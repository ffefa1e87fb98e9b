// The pictures that clients fetch: finished files, and previews that are made in the background. Thread safe.
#pragma once

#include <functional>
#include <string>

#include "coordinator/core/spool.h"
#include "coordinator/core_thread.h"
#include "coordinator/picture_stream.h"
#include "coordinator/store/picture_store.h"
#include "coordinator/task_pool.h"
#include "proto/jobs.grpc.pb.h"
#include "renderer/util/result.h"

namespace tessera {

class CallGate;

class PictureFetches {
 public:
  // `brief`: reads files, and must run until every call has ended.
  PictureFetches(const CallGate& gate, const PictureStore& pictures, TaskPool& brief);
  // Finishes what runs in the background.
  void Stop() { background_.Stop(); }

  grpc::ServerWriteReactor<proto::PictureChunk>* Fetch(grpc::CallbackServerContext* context,
                                                       const proto::FetchRequest& request);
  // The sums of the job are not readable for a moment.
  static grpc::Status BeingWritten();

 private:
  // Passes the stream on to whoever sends the picture, or returns why there is none.
  grpc::Status Begin(CoreContext& core, PictureStream* stream, FrameId id, bool preview);
  // Makes or opens the picture of a stream in the background and sends it: `make` returns a Result of its
  // bytes or its file. `refuse` is called with the reason if it is damaged; without it, or if memory or
  // descriptors are lacking, the stream gets the reason. An error if too many wait.
  template <typename Make>
  grpc::Status SendLater(PictureStream* stream, Make make,
                         std::function<void(const std::string& reason)> refuse = nullptr);
  grpc::Status SendFile(PictureStream* stream, FrameId id, const PictureFile& file);

  const CallGate& gate_;
  const PictureStore& pictures_;
  PictureStreams streams_;
  TaskPool background_{1};
};

}  // namespace tessera
