// What the interface for programs asks of the farm. The shell of the coordinator provides it.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "coordinator/core/schedule/picture_file.h"
#include "coordinator/web/farm_view.h"
#include "coordinator/web/http_response.h"
#include "coordinator/web/web_gate.h"
#include "renderer/film/frame_snapshot.h"
#include "renderer/util/readable_file.h"
#include "renderer/util/result.h"

namespace tessera {

// Why a request is not answered, as a status of HTTP and a sentence for people.
struct WebError {
  int status = 503;
  std::string reason;
};
template <typename Value>
using WebResult = std::variant<Value, WebError>;
// Called once, from any thread.
template <typename Value>
using WebDone = std::function<void(WebResult<Value>)>;

struct WebCaller {
  Visitor visitor;
  std::string peer;  // the address of the connection, for logs
};

// What a role may do with a call of the protocol (coordinator/access.h).
enum class WebReach { kNothing, kOwn, kEverything };

struct JobChange {
  std::string_view call;  // "Jobs.Pause" and so on: a constant
  JobId job{};
  int64_t value = 0;  // the priority or the number of samples per pixel
};

// A unit that a worker has.
struct LeasedUnit {
  PixelBounds bounds;
  SampleRange range;
  WorkerId worker{};
  bool has_started = false;
};

struct JobDetail {
  JobStatus status;
  std::shared_ptr<const JobSpec> spec;
  std::vector<FrameStatus> frames;
  std::vector<LeasedUnit> units;  // of one frame, at most kUnitsShownMax
};
constexpr size_t kUnitsShownMax = 2000;

// A frame at one moment.
struct FrameState {
  JobStatus status;
  std::shared_ptr<const JobSpec> spec;
  std::optional<FrameSnapshot> snapshot;  // if it is being rendered
  std::optional<PictureFile> file;        // if it was written
  std::chrono::microseconds cost{};       // that the core thread had with it
  bool has_failed = false;                // no worker can render it

  // Whether nothing more of it will be rendered.
  bool IsOver() const { return has_failed || HasEnded(status.state); }
};

// Functions are thread safe. Those without a WebDone may wait for the core thread or the disk.
struct WebFarm {
  // Whether the caller may make the call at all; a refusal is logged.
  std::function<std::optional<WebError>(const WebCaller& caller, std::string_view call)> admit;
  std::function<WebReach(const Visitor& visitor, std::string_view call)> reach;
  // Whether the caller may make the call for a job, which is known to exist then.
  std::function<void(const WebCaller& caller, std::string_view call, JobId job, WebDone<JobStatus> done)>
      admit_to_job;
  // Returns nullopt if the farm is too busy.
  std::function<std::optional<FarmView>()> view;
  // With the units of frame `frame`.
  std::function<void(JobId job, uint32_t frame, WebDone<JobDetail> done)> detail;
  // Submits a job whose frames a worker makes. Entered in the audit log, as the next two.
  std::function<void(const WebCaller& caller, const JobOrder& order, WebDone<JobStatus> done)> order_job;
  std::function<void(const WebCaller& caller, const JobChange& change, WebDone<JobStatus> done)> change_job;
  std::function<void(const WebCaller& caller, std::string_view call, const std::string& which,
                     WebDone<std::vector<WorkerStatus>> done)>
      change_workers;
  std::function<WebResult<FrameState>(JobId job, uint32_t frame)> frame;
  // Entries of the log of a job with numbers larger than `after`.
  std::function<WebResult<JobLogPage>(JobId job, uint64_t after, size_t limit)> log;
  // The bytes of the EXR file of a frame; without `file`, what was written of one whose job ended early.
  std::function<WebResult<std::string>(JobId job, uint32_t frame, const std::optional<PictureFile>& file)>
      read;
  // The same file, to be sent in pieces.
  std::function<WebResult<ReadableFile>(JobId job, uint32_t frame, const std::optional<PictureFile>& file)>
      open;
  // Keeps bytes that are being sent in a file: a slow reader takes no memory. An error if there is no room.
  std::function<Result<ReadableFile>(std::string_view bytes)> keep;
  // Those of these blobs that the farm lacks, each with the number of its first bytes that need not be sent
  // again.
  std::function<void(const std::vector<Digest>& digests, WebDone<std::map<Digest, uint64_t>> done)>
      find_missing;
  // Receives a blob of `size` bytes from `offset` on, and enters that in the audit log.
  std::function<std::shared_ptr<BodySink>(const WebCaller& caller, const Digest& digest, uint64_t size,
                                          uint64_t offset)>
      receive_blob;
  // Runs a task that may take long on another thread.
  std::function<void(std::function<void()> task)> run_later;
};

}  // namespace tessera
