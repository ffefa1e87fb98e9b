// Serves proto/jobs.proto: each call becomes an event of the core thread. Thread safe.
#pragma once

#include "coordinator/background_thread.h"
#include "coordinator/store/picture_store.h"
#include "proto/blobs/blob_store.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace tessera {

class CallGate;

class JobsService final : public proto::Jobs::CallbackService {
 public:
  JobsService(const CallGate& gate, const BlobStore& blobs, const PictureStore& pictures)
      : gate_(gate), blobs_(blobs), pictures_(pictures) {}
  // Finishes what runs in the background. Call it before the server is destroyed, so that every call is
  // answered.
  void Stop() { background_.Stop(); }

  grpc::ServerUnaryReactor* Submit(grpc::CallbackServerContext* context, const proto::JobSpec* request,
                                   proto::SubmitAnswer* answer) override;
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const proto::ListRequest* request,
                                 proto::ListAnswer* answer) override;
  grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::JobStatus* answer) override;
  grpc::ServerWriteReactor<proto::JobStatus>* Watch(grpc::CallbackServerContext* context,
                                                    const proto::JobRequest* request) override;
  grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::JobStatus* answer) override;
  grpc::ServerUnaryReactor* Extend(grpc::CallbackServerContext* context, const proto::ExtendRequest* request,
                                   proto::JobStatus* answer) override;
  grpc::ServerUnaryReactor* Pause(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                  proto::JobStatus* answer) override;
  grpc::ServerUnaryReactor* Resume(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::JobStatus* answer) override;
  grpc::ServerUnaryReactor* SetPriority(grpc::CallbackServerContext* context,
                                        const proto::PriorityRequest* request,
                                        proto::JobStatus* answer) override;
  grpc::ServerUnaryReactor* Workers(grpc::CallbackServerContext* context,
                                    const proto::WorkersRequest* request,
                                    proto::WorkersAnswer* answer) override;
  grpc::ServerUnaryReactor* Frames(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::FramesAnswer* answer) override;
  grpc::ServerUnaryReactor* DrainWorkers(grpc::CallbackServerContext* context,
                                         const proto::WorkersRequest* request,
                                         proto::WorkersAnswer* answer) override;
  grpc::ServerUnaryReactor* ReleaseWorkers(grpc::CallbackServerContext* context,
                                           const proto::WorkersRequest* request,
                                           proto::WorkersAnswer* answer) override;
  grpc::ServerWriteReactor<proto::PictureChunk>* FetchPicture(grpc::CallbackServerContext* context,
                                                              const proto::FetchRequest* request) override;
  grpc::ServerUnaryReactor* Health(grpc::CallbackServerContext* context, const proto::HealthRequest* request,
                                   proto::HealthAnswer* answer) override;

 private:
  const CallGate& gate_;
  const BlobStore& blobs_;
  const PictureStore& pictures_;
  BackgroundThread background_;
};

}  // namespace tessera
