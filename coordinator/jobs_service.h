// Serves proto/jobs.proto: each call becomes an event of the core thread. Thread safe.
#pragma once

#include "coordinator/job_changes.h"
#include "coordinator/picture_fetches.h"
#include "coordinator/task_pool.h"
#include "proto/blobs/blob_store.h"
#include "proto/jobs.grpc.pb.h"
#include "proto/terms.h"

namespace tessera {

class JobLog;
struct FileThreads;

class JobsService final : public proto::Jobs::Service {
 public:
  // The threads must run until every call has ended.
  JobsService(const CallGate& gate, const BlobStore& blobs, const PictureStore& pictures,
              const class JobLog& log, FileThreads& threads);
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
  grpc::ServerUnaryReactor* Workers(grpc::CallbackServerContext* context,
                                    const proto::WorkersRequest* request, proto::WorkersAnswer* answer);
  grpc::ServerUnaryReactor* Frames(grpc::CallbackServerContext* context, const proto::JobRequest* request,
                                   proto::FramesAnswer* answer);
  grpc::ServerWriteReactor<proto::PictureChunk>* FetchPicture(grpc::CallbackServerContext* context,
                                                              const proto::FetchRequest* request);
  grpc::ServerUnaryReactor* JobLog(grpc::CallbackServerContext* context, const proto::JobLogRequest* request,
                                   proto::JobLogAnswer* answer);
  grpc::ServerUnaryReactor* Health(grpc::CallbackServerContext* context, const proto::HealthRequest* request,
                                   proto::HealthAnswer* answer);

 private:
  // Serves the calls that change jobs and workers (job_changes.h, worker_changes.h).
  void ServeChanges();

  const CallGate& gate_;
  const BlobStore& blobs_;
  const class JobLog& log_;
  FileThreads& threads_;
  const JobChanges changes_;
  PictureFetches pictures_;
};

}  // namespace tessera
