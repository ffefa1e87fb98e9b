// One client that watches a job.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "proto/jobs.grpc.pb.h"
#include "proto/terms.h"

namespace tessera {

// The stream deletes itself when the call is over. Updates go through its link, which outlives it. Thread
// safe.
class WatchStream final : public grpc::ServerWriteReactor<proto::JobStatus> {
 public:
  class Link {
   public:
    // Sends the status, or keeps it until the one before is sent: a slow client misses some, but never the
    // last. Null means that the coordinator is shutting down. Returns false if the client is gone.
    bool Offer(const JobStatus* status, bool last);
    void Finish(const grpc::Status& status);
    // Whether the client is still there.
    bool IsOpen();

   private:
    friend class WatchStream;
    void SendNext();  // with the mutex held

    std::mutex mutex_;
    WatchStream* stream_ = nullptr;  // null once the call is over or finishing
    std::optional<JobStatus> next_;
    bool sending_ = false, last_ = false;
    proto::JobStatus message_;
  };

  WatchStream();
  std::shared_ptr<Link> link() { return link_; }

 private:
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override { delete this; }

  std::shared_ptr<Link> link_;
};

}  // namespace tessera
