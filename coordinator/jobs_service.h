// Serves proto/jobs.proto: each call becomes an event of the core thread. Thread safe.
#pragma once

#include "coordinator/picture_fetches.h"
#include "coordinator/task_pool.h"
#include "proto/blobs/blob_store.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/terms.h"

namespace tessera {

class CallGate;
class JobLog;
struct FileThreads;

class JobsService final : public proto::Jobs::Service {
 public:
  // The threads must run until every call has ended.
  JobsService(const CallGate& gate, const BlobStore& blobs, const PictureStore& pictures,
              const class JobLog& log, const std::string& data_dir, FileThreads& threads);
  // Finishes what runs in the background. Call it before the server is destroyed, so that every call is
  // answered.
  void Stop() { pictures_.Stop(); }

  grpc::ServerUnaryReactor* Submit(grpc::CallbackServerContext* context, const proto::JobSpec* request,
                                   proto::SubmitAnswer* answer);
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const proto::ListRequest* request,
                                 proto::ListAnswer* answer);
  grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::JobStatus* answer);
  grpc::ServerWriteReactor<proto::JobStatus>* Watch(grpc::CallbackServerContext* context,
                                                    const proto::JobRequest* request);
  grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::JobStatus* answer);
  grpc::ServerUnaryReactor* Extend(grpc::CallbackServerContext* context, const proto::ExtendRequest* request,
                                   proto::JobStatus* answer);
  grpc::ServerUnaryReactor* Pause(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                  proto::JobStatus* answer);
  grpc::ServerUnaryReactor* Resume(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::JobStatus* answer);
  grpc::ServerUnaryReactor* SetPriority(grpc::CallbackServerContext* context,
                                        const proto::PriorityRequest* request, proto::JobStatus* answer);
  grpc::ServerUnaryReactor* Workers(grpc::CallbackServerContext* context,
                                    const proto::WorkersRequest* request, proto::WorkersAnswer* answer);
  grpc::ServerUnaryReactor* Frames(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::FramesAnswer* answer);
  grpc::ServerUnaryReactor* DrainWorkers(grpc::CallbackServerContext* context,
                                         const proto::WorkersRequest* request, proto::WorkersAnswer* answer);
  grpc::ServerUnaryReactor* ReleaseWorkers(grpc::CallbackServerContext* context,
                                           const proto::WorkersRequest* request,
                                           proto::WorkersAnswer* answer);
  grpc::ServerWriteReactor<proto::PictureChunk>* FetchPicture(grpc::CallbackServerContext* context,
                                                              const proto::FetchRequest* request);
  grpc::ServerUnaryReactor* JobLog(grpc::CallbackServerContext* context, const proto::JobLogRequest* request,
                                   proto::JobLogAnswer* answer);
  grpc::ServerUnaryReactor* Health(grpc::CallbackServerContext* context, const proto::HealthRequest* request,
                                   proto::HealthAnswer* answer);

 private:
  const CallGate& gate_;
  const BlobStore& blobs_;
  const class JobLog& log_;
  FileThreads& threads_;
  PictureFetches pictures_;
};

}  // namespace tessera
