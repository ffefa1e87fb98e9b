// What `tessera` asks of a coordinator.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "client/coordinator/packed_scene.h"
#include "proto/terms.h"
#include "renderer/util/result.h"

namespace grpc {
class Channel;
}

namespace tessera {

struct UploadReport {
  size_t files_total = 0;  // different ones
  size_t files_sent = 0;
  uint64_t bytes_sent = 0;  // with the list of files, and with what had to be sent again
};

// Every call waits for its answer and tries again, with bounded patience, while the coordinator is away. A
// request to stop ends any of them with kInterrupted. Used by one thread at a time.
class CoordinatorClient {
 public:
  // `address` is HOST:PORT or unix:PATH. An error if nobody answers there within `patience` or only another
  // version of the protocol. Calls `on_silence`, if given, once when the answer does not come at once.
  static Result<std::unique_ptr<CoordinatorClient>> Connect(
      const std::string& address, std::chrono::milliseconds patience, std::stop_token stop,
      const std::function<void()>& on_silence = nullptr);
  ~CoordinatorClient();
  CoordinatorClient(const CoordinatorClient&) = delete;
  CoordinatorClient& operator=(const CoordinatorClient&) = delete;

  // Sends the files of the scene that the coordinator lacks, several at the same time.
  Result<UploadReport> Upload(const PackedScene& scene);
  // What is asked for beside the picture.
  struct Wishes {
    std::string name;
    int priority = 0;
    std::set<std::string> required_tags;
    double verify_share = 0;
  };
  Result<JobId> Submit(const PackedScene& scene, const Wishes& wishes);
  Result<JobStatus> Status(JobId job);
  // Calls `report` with every change until the job has ended, and answers its last status.
  Result<JobStatus> Watch(JobId job, const std::function<void(const JobStatus&)>& report);
  // The job's frames, in order. Never empty.
  Result<std::vector<FrameStatus>> Frames(JobId job);
  // The bytes of the OpenEXR file of a frame, by its index.
  Result<std::string> FetchPicture(JobId job, uint32_t frame, bool preview);
  // Each answers the job's status after it.
  Result<JobStatus> Cancel(JobId job);
  Result<JobStatus> Extend(JobId job, uint32_t samples_per_pixel);
  Result<JobStatus> Pause(JobId job);
  Result<JobStatus> Resume(JobId job);
  Result<JobStatus> SetPriority(JobId job, int priority);
  Result<std::vector<JobStatus>> Jobs();
  Result<std::vector<WorkerStatus>> Workers();
  // Of the workers of a name, or the one of a number; each answers them after it.
  Result<std::vector<WorkerStatus>> Drain(const std::string& which);
  Result<std::vector<WorkerStatus>> Release(const std::string& which);

 private:
  struct Connection;
  explicit CoordinatorClient(std::unique_ptr<Connection> connection);
  std::unique_ptr<Connection> connection_;
};

}  // namespace tessera
