// The calls that `tessera` makes to a coordinator.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "client/coordinator/packed_scene.h"
#include "client/coordinator/received_picture.h"
#include "proto/membership.h"
#include "proto/terms.h"
#include "proto/wire/endpoint.h"
#include "renderer/util/result.h"

namespace grpc {
class Channel;  // NOLINT(bugprone-forward-declaration-namespace): not that of a film
}

namespace tessera {

struct UploadReport {
  size_t files_total = 0;  // with different contents
  size_t files_sent = 0;
  uint64_t bytes_sent = 0;  // including the list of files and everything that was sent twice
};

// How long to wait for a coordinator.
struct Patience {
  // Until it answers for the first time. A restart takes less, and a mistyped address should not cost more.
  std::chrono::milliseconds connection{15'000};
  // While it is away or asks to try again later.
  std::chrono::milliseconds calls{60'000};
};

// Every call is meant for the farm that answered Connect, and fails if another farm answers at the address
// later. Every call waits for its answer and is repeated with growing pauses while the coordinator is away or
// asks to try again. A request to stop ends each of them with kInterrupted. Used by one thread at a time.
class CoordinatorClient {
 public:
  // Prepares the process for encrypted connections. Call it first, before any thread is started.
  static void PrepareProcess();
  // Starts the threads that connections need, or fails if the system grants too few. Connect starts them too;
  // call this before other processes of this user are started.
  static Result<void> StartThreads();
  using OnSlow = std::function<void(const std::string& reason)>;
  // Fails if no coordinator answers there in time or if its version differs. If the answer takes longer than
  // a moment, calls `on_slow`, if given, once with the reason.
  static Result<std::unique_ptr<CoordinatorClient>> Connect(const Endpoint& endpoint,
                                                            const Patience& patience, std::stop_token stop,
                                                            const OnSlow& on_slow = nullptr);
  ~CoordinatorClient();
  CoordinatorClient(const CoordinatorClient&) = delete;
  CoordinatorClient& operator=(const CoordinatorClient&) = delete;

  // Sends the files of the scene that the coordinator lacks, several in parallel. If a file has to wait,
  // calls `on_slow`, if given, once with the reason.
  Result<UploadReport> Upload(const PackedScene& scene, const OnSlow& on_slow = nullptr);
  struct SubmitOptions {
    std::string name;
    int priority = 0;
    std::set<std::string> required_tags;
    double verify_share = 0;
    std::optional<Region> first = std::nullopt;  // of each frame: rendered before the rest
    // Names the submission: the job of an earlier one of the same number is returned instead. 0: random.
    uint64_t submission = 0;
  };
  // Submits the scene once its files were sent. Sends those again that the coordinator found damaged, or
  // removed to make room, since then.
  Result<JobId> Submit(const PackedScene& scene, const SubmitOptions& options);
  Result<JobStatus> Status(JobId job);
  // Calls `report` with every change until the job has ended. Returns its last status.
  Result<JobStatus> Watch(JobId job, const std::function<void(const JobStatus&)>& report);
  // Returns the job's frames, in order. Never empty.
  Result<std::vector<FrameStatus>> Frames(JobId job);
  // Returns the OpenEXR file of a frame, given by its index. `folder`: for one that is too large to be held
  // in memory.
  Result<ReceivedPicture> FetchPicture(JobId job, uint32_t frame, bool preview, const std::string& folder);
  // Entries of the job's log with numbers larger than `after`, oldest first.
  Result<JobLogPage> JobLog(JobId job, uint64_t after);
  // Each returns the status of the job after the change.
  Result<JobStatus> Cancel(JobId job);
  Result<JobStatus> Extend(JobId job, uint32_t samples_per_pixel);
  Result<JobStatus> Pause(JobId job);
  Result<JobStatus> Resume(JobId job);
  Result<JobStatus> SetPriority(JobId job, int priority);
  // Each sets `left_out` to the number of those that are not in the list because it would be too large: the
  // oldest jobs, or some workers.
  Result<std::vector<JobStatus>> Jobs(uint64_t& left_out);
  Result<std::vector<WorkerStatus>> Workers(uint64_t& left_out);
  // `which` is the name of some workers or the id of one. Each returns those workers after the change, as
  // Workers does.
  Result<std::vector<WorkerStatus>> Drain(const std::string& which, uint64_t& left_out);
  Result<std::vector<WorkerStatus>> Release(const std::string& which, uint64_t& left_out);
  struct Access {
    std::vector<TokenStatus> tokens;
    std::vector<MemberStatus> members;
  };
  Result<Access> ListAccess();
  // `which` is the name of some members or tokens, or the id of one. Returns those after the change.
  Result<Access> Revoke(const std::string& which);

 private:
  struct Connection;
  explicit CoordinatorClient(std::unique_ptr<Connection> connection);
  std::unique_ptr<Connection> connection_;
};

}  // namespace tessera
