#include "client/coordinator/coordinator_client.h"

#include <fmt/format.h>

#include "client/coordinator/coordinator_connection.h"
#include "proto/shell/console.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/wire/membership_calls.h"
#include "proto/wire/reachability.h"
#include "proto/wire/tls_credentials.h"

namespace tessera {
namespace {

// How long a connection attempt may take before the user is informed.
constexpr std::chrono::seconds kSlowConnection{1};
// How long a stop may go unnoticed while connecting.
constexpr std::chrono::milliseconds kConnectSlice{100};
// For a coordinator that is away while a job is watched: its machine may be restarting.
constexpr std::chrono::milliseconds kWatchPatience = std::chrono::minutes(30);
// Submissions of a scene whose stored files turn out to be damaged. One suffices unless the disk of the
// coordinator is failing.
constexpr int kSubmitAttemptsMax = 3;
constexpr uint64_t kPictureSizeMax = uint64_t{8} << 30;  // bytes: the largest frame in floats

// Makes one call with one answer.
template <typename Connection, typename Request, typename Answer>
Result<void> Call(const Connection& connection,
                  grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*, const Request&, Answer*),
                  const Request& request, Answer& answer, const std::string& what) {
  return WithRetries(connection, what, [&] {
    CallContext context(connection.stop, connection.farm, kCallPatience);
    return ((*connection.jobs).*method)(context.get(), request, &answer);
  });
}

proto::JobRequest RequestFor(JobId job) {
  proto::JobRequest request;
  request.set_job(Number(job));
  return request;
}

// The same, and reads the answer with `read`.
template <typename Connection, typename Request, typename Answer, typename Value>
Result<Value> Ask(const Connection& connection,
                  grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*, const Request&, Answer*),
                  const Request& request, const std::string& what, Result<Value> (*read)(const Answer&)) {
  Answer answer;
  if (auto asked = Call(connection, method, request, answer, what); !asked) return asked.error();
  return read(answer);
}

// Makes a call about a job that is answered with the job's status.
template <typename Connection, typename Request>
Result<JobStatus> AskAboutJob(Connection& connection,
                              grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*, const Request&,
                                                                        proto::JobStatus*),
                              const Request& request, const char* verb) {
  return Ask(connection, method, request, fmt::format("{} job {}", verb, request.job()), &ReadJobStatus);
}

// Makes a call about some workers that is answered with their status.
template <typename Connection>
Result<std::vector<WorkerStatus>> AskAboutWorkers(
    Connection& connection,
    grpc::Status (proto::Jobs::Stub::*method)(grpc::ClientContext*, const proto::WorkersRequest&,
                                              proto::WorkersAnswer*),
    const std::string& which, const std::string& what, uint64_t& left_out) {
  proto::WorkersRequest request;
  request.set_which(CleanName(which));
  proto::WorkersAnswer answer;
  auto asked = Call(connection, method, request, answer, what);
  if (!asked) return asked.error();
  left_out = answer.left_out();
  std::vector<WorkerStatus> workers;
  for (const proto::WorkerStatus& message : answer.workers()) {
    auto status = ReadWorkerStatus(message);
    if (!status) return status.error();
    workers.push_back(std::move(*status));
  }
  return workers;
}

// Sets `kept` to an error that is not the coordinator's, and ends the call.
grpc::Status NotKept(grpc::ClientContext* context, const Error& error, Result<void>& kept) {
  context->TryCancel();
  kept = error;
  return {grpc::StatusCode::FAILED_PRECONDITION, error.message};
}

// Receives one picture. `kept`: whether this machine could keep it.
grpc::Status ReceivePicture(proto::Jobs::Stub& stub, grpc::ClientContext* context,
                            const proto::FetchRequest& request, ReceivedPicture& picture,
                            Result<void>& kept) {
  const auto reader = stub.FetchPicture(context, request);
  proto::PictureChunk chunk;
  uint64_t size = 0;
  std::string digest;
  for (bool first = true; reader->Read(&chunk); first = false) {
    if (first) {
      size = chunk.size();
      digest = chunk.digest();
    }
    if (size > kPictureSizeMax || picture.size() + chunk.data().size() > size) {
      context->TryCancel();
      return {grpc::StatusCode::DATA_LOSS, "the picture does not have the announced size"};
    }
    // Any number of them could follow.
    if (chunk.data().empty() && !first) {
      context->TryCancel();
      return {grpc::StatusCode::DATA_LOSS, "the coordinator sent a part of the picture without data"};
    }
    if (const auto added = picture.Add(chunk.data()); !added) return NotKept(context, added.error(), kept);
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return status;
  const auto bytes = picture.Bytes();
  if (!bytes) return NotKept(context, bytes.error(), kept);
  if (bytes->size() != size || WriteDigest(Sha256(*bytes)) != digest) {
    return {grpc::StatusCode::DATA_LOSS, "the picture was corrupted in transit (SHA-256 mismatch)"};
  }
  return status;
}

// Compares the statuses of a job that is watched. A data directory that was restored to an earlier state has
// the same farm, and may have another job of the same number or none.
class WatchedJob {
 public:
  // `submission` of the job if it is known, otherwise 0.
  WatchedJob(JobId job, uint64_t submission) : job_(job), submission_(submission) {}
  Result<void> Check(const JobStatus& status) {
    if (submission_ == 0) submission_ = status.submission;
    if (status.submission == submission_) return {};
    return Failed(
        fmt::format("cannot watch job {0}: it is gone, and {0} is the number of another job now: the data "
                    "directory of the coordinator was restored to an earlier state",
                    Number(job_)));
  }
  // The error of a call that failed for good.
  Error ErrorOf(const grpc::Status& status, Error error) const {
    if (status.error_code() != grpc::StatusCode::NOT_FOUND || submission_ == 0) return error;
    return Failed(error.message +
                  " any more: the data directory of the coordinator was restored to an earlier state, or the "
                  "job has ended and was forgotten");
  }

 private:
  const JobId job_;
  uint64_t submission_;
};

std::string WhyNotConnected(const Reachability& found) {
  return found.speaks_http2 ? "it accepts connections intermittently" : found.reason;
}

Result<void> WaitForCoordinator(grpc::Channel& channel, const Endpoint& endpoint,
                                std::chrono::milliseconds patience, std::stop_token stop,
                                const CoordinatorClient::OnSlow& on_slow) {
  const auto start = std::chrono::steady_clock::now();
  std::optional<ReachabilityCheck> check;
  bool reported = on_slow == nullptr;
  while (!WaitForConnection(channel, kConnectSlice)) {
    if (stop.stop_requested()) return Error{ErrorKind::kInterrupted, "interrupted"};
    const auto waited = std::chrono::steady_clock::now() - start;
    if (waited > patience) {
      // What holds now, and not what a check found out earlier.
      return Failed(fmt::format("{}: no coordinator answered within {:.0f} s: {}", endpoint.address.Text(),
                                std::chrono::duration<double>(patience).count(),
                                WhyNotConnected(CheckReachability(endpoint, stop))));
    }
    if (!reported && waited > kSlowConnection && !check) check.emplace(endpoint);
    if (const auto found = !reported && check ? check->Await({}) : std::nullopt) {
      on_slow(WhyNotConnected(*found));
      reported = true;
    }
  }
  return {};
}

}  // namespace

Error CoordinatorClient::Connection::ErrorOf(const grpc::Status& status, const std::string& what) const {
  const bool is_unanswered = status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                             status.error_code() == grpc::StatusCode::UNIMPLEMENTED;
  if (!is_unanswered || stop.stop_requested()) return ToError(status, what);
  return Failed(fmt::format("{}: cannot {}: {}", endpoint.address.Text(), what,
                            DescribeOutage(CheckReachability(endpoint, stop), status)));
}

CoordinatorClient::CoordinatorClient(std::unique_ptr<Connection> connection)
    : connection_(std::move(connection)) {}
CoordinatorClient::~CoordinatorClient() = default;

void CoordinatorClient::PrepareProcess() {
  PrepareTls();
}

Result<void> CoordinatorClient::StartThreads() {
  return StartGrpc();
}

Result<std::unique_ptr<CoordinatorClient>> CoordinatorClient::Connect(const Endpoint& endpoint,
                                                                      const Patience& patience,
                                                                      std::stop_token stop,
                                                                      const OnSlow& on_slow) {
  std::unique_ptr<Connection> connection(
      new Connection{endpoint, patience.calls, stop, {}, {}, OpenChannel(endpoint), {}, {}, {}});
  connection->jobs = proto::Jobs::NewStub(connection->channel);
  connection->blobs = proto::Blobs::NewStub(connection->channel);
  connection->access = proto::Access::NewStub(connection->channel);
  auto reached = WaitForCoordinator(*connection->channel, endpoint, patience.connection, stop, on_slow);
  if (!reached) return reached.error();
  proto::HealthAnswer health;
  auto asked = Call(*connection, &proto::Jobs::Stub::Health, proto::HealthRequest(), health,
                    "ask the coordinator for its version");
  if (!asked) return asked.error();
  if (health.protocol() != kProtocolVersion || health.software_version() != kSoftwareVersion) {
    return Failed(
        fmt::format("{}: the coordinator has version {} (protocol {}) and this program version {} (protocol "
                    "{}); install the same release on both",
                    endpoint.address.Text(), CleanName(health.software_version()), health.protocol(),
                    kSoftwareVersion, kProtocolVersion));
  }
  if (endpoint.login) {
    if (const auto renewed = RenewIfDue(*endpoint.login, connection->channel); !renewed)
      PrintNote("tessera: warning: {}\n", renewed.error().message);
  }
  const auto farm = ReadFarmId(health.farm());
  if (!farm) return farm.error();
  connection->farm = *farm;
  return std::unique_ptr<CoordinatorClient>(new CoordinatorClient(std::move(connection)));
}

Result<JobId> CoordinatorClient::Submit(const PackedScene& scene, const SubmitOptions& options) {
  JobSpec spec;
  spec.submission = options.submission != 0 ? options.submission : RandomId();
  spec.name = options.name;
  spec.priority = options.priority;
  spec.required_tags = options.required_tags;
  spec.verify_share = options.verify_share;
  spec.first = options.first;
  spec.package = scene.digest;
  spec.frames = scene.frames;
  proto::JobSpec request;
  Write(spec, request);
  for (int attempt = 1;; ++attempt) {
    proto::SubmitAnswer answer;
    auto asked = Call(*connection_, &proto::Jobs::Stub::Submit, request, answer, "submit the job");
    if (asked) {
      const JobId job{answer.job()};
      connection_->submissions[job] = spec.submission;
      return job;
    }
    if (attempt == kSubmitAttemptsMax) return asked.error();
    const auto sent = Upload(scene);
    if (!sent || sent->bytes_sent == 0) return asked.error();
  }
}

Result<JobStatus> CoordinatorClient::Status(JobId job) {
  return AskAboutJob(*connection_, &proto::Jobs::Stub::Status, RequestFor(job), "get the status of");
}

Result<JobStatus> CoordinatorClient::Cancel(JobId job) {
  return AskAboutJob(*connection_, &proto::Jobs::Stub::Cancel, RequestFor(job), "cancel");
}

Result<JobStatus> CoordinatorClient::Pause(JobId job) {
  return AskAboutJob(*connection_, &proto::Jobs::Stub::Pause, RequestFor(job), "pause");
}

Result<JobStatus> CoordinatorClient::Resume(JobId job) {
  return AskAboutJob(*connection_, &proto::Jobs::Stub::Resume, RequestFor(job), "resume");
}

Result<JobLogPage> CoordinatorClient::JobLog(JobId job, uint64_t after) {
  proto::JobLogRequest request;
  request.set_job(Number(job));
  request.set_after(after);
  return Ask(*connection_, &proto::Jobs::Stub::JobLog, request,
             fmt::format("read the log of job {}", Number(job)), &ReadJobLog);
}

Result<JobStatus> CoordinatorClient::SetPriority(JobId job, int priority) {
  proto::PriorityRequest request;
  request.set_job(Number(job));
  request.set_priority(priority);
  return AskAboutJob(*connection_, &proto::Jobs::Stub::SetPriority, request, "change the priority of");
}

Result<JobStatus> CoordinatorClient::Extend(JobId job, uint32_t samples_per_pixel) {
  proto::ExtendRequest request;
  request.set_job(Number(job));
  request.set_samples_per_pixel(samples_per_pixel);
  return AskAboutJob(*connection_, &proto::Jobs::Stub::Extend, request, "extend");
}

Result<JobStatus> CoordinatorClient::Watch(JobId job, const std::function<void(const JobStatus&)>& report) {
  const std::string what = fmt::format("watch job {}", Number(job));
  Retries retries(connection_->channel, connection_->stop, std::max(kWatchPatience, connection_->patience));
  const auto submitted = connection_->submissions.find(job);
  WatchedJob watched(job, submitted == connection_->submissions.end() ? 0 : submitted->second);
  while (true) {
    CallContext context(connection_->stop, connection_->farm);
    const auto reader = connection_->jobs->Watch(context.get(), RequestFor(job));
    proto::JobStatus message;
    while (reader->Read(&message)) {
      const auto status = ReadJobStatus(message);
      if (!status) return status.error();
      if (const auto same = watched.Check(*status); !same) return same.error();
      report(*status);
      if (HasEnded(status->state)) return status;
      retries.Progress();
    }
    grpc::Status status = reader->Finish();
    if (status.ok()) status = {grpc::StatusCode::UNAVAILABLE, "the coordinator closed the stream"};
    if (!retries.Again(status)) return watched.ErrorOf(status, connection_->ErrorOf(status, what));
  }
}

Result<std::vector<FrameStatus>> CoordinatorClient::Frames(JobId job) {
  return Ask(*connection_, &proto::Jobs::Stub::Frames, RequestFor(job),
             fmt::format("list the frames of job {}", Number(job)), &ReadFrameStatuses);
}

Result<ReceivedPicture> CoordinatorClient::FetchPicture(JobId job, uint32_t frame, bool preview,
                                                        const std::string& folder) {
  proto::FetchRequest request;
  request.set_job(Number(job));
  request.set_frame(frame);
  request.set_preview(preview);
  ReceivedPicture picture(folder);
  Result<void> kept;
  auto fetched = WithRetries(*connection_, fmt::format("fetch the picture of job {}", Number(job)), [&] {
    CallContext context(connection_->stop, connection_->farm);
    picture = ReceivedPicture(folder);
    return ReceivePicture(*connection_->jobs, context.get(), request, picture, kept);
  });
  if (!kept) return kept.error();
  if (!fetched) return fetched.error();
  return picture;
}

Result<std::vector<JobStatus>> CoordinatorClient::Jobs(uint64_t& left_out) {
  proto::ListAnswer answer;
  auto asked = Call(*connection_, &proto::Jobs::Stub::List, proto::ListRequest(), answer, "list the jobs");
  if (!asked) return asked.error();
  left_out = answer.left_out();
  std::vector<JobStatus> jobs;
  for (const proto::JobStatus& message : answer.jobs()) {
    auto status = ReadJobStatus(message);
    if (!status) return status.error();
    jobs.push_back(std::move(*status));
  }
  return jobs;
}

Result<std::vector<WorkerStatus>> CoordinatorClient::Workers(uint64_t& left_out) {
  return AskAboutWorkers(*connection_, &proto::Jobs::Stub::Workers, "", "list the workers", left_out);
}

Result<std::vector<WorkerStatus>> CoordinatorClient::Drain(const std::string& which, uint64_t& left_out) {
  return AskAboutWorkers(*connection_, &proto::Jobs::Stub::DrainWorkers, which, "drain " + which, left_out);
}

Result<std::vector<WorkerStatus>> CoordinatorClient::Release(const std::string& which, uint64_t& left_out) {
  return AskAboutWorkers(*connection_, &proto::Jobs::Stub::ReleaseWorkers, which, "release " + which,
                         left_out);
}

}  // namespace tessera
