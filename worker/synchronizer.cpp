#include "worker/synchronizer.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"
#include "renderer/load/limited_load.h"
#include "renderer/text/unicode.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

// Beyond the wait that was agreed; then the call counts as lost.
constexpr std::chrono::seconds kAnswerPatience{20};
// News that arrives faster than answers waits for one.
constexpr size_t kOpenCallsMax = 3;
constexpr std::chrono::milliseconds kCallAgainMax{10'000};

// Between attempts to join a farm that is full. Places become free seldom, and each attempt costs the
// coordinator a call.
constexpr std::chrono::milliseconds kJoinAgainFirst{1000};
constexpr std::chrono::milliseconds kJoinAgainMax{60'000};

// Whether the coordinator will never admit this worker as it is. Everything else may pass: a farm that is
// full, a proxy without its coordinator.
bool IsRefusal(const grpc::Status& status) {
  const auto code = status.error_code();
  return code == grpc::StatusCode::FAILED_PRECONDITION || code == grpc::StatusCode::INVALID_ARGUMENT ||
         code == grpc::StatusCode::UNAUTHENTICATED || code == grpc::StatusCode::PERMISSION_DENIED;
}

}  // namespace

// One Synchronize call that is not answered. gRPC's thread touches it once, to report that it is done, and
// must not own it: a call holds its channel, and the last owner of a channel waits for gRPC's threads to end.
struct Synchronizer::Call {
  uint64_t sequence = 0;
  std::vector<LeaseId> returned;
  std::unique_ptr<proto::Work::Stub> stub;
  grpc::ClientContext context;
  proto::WorkerState request;
  proto::WorkerDirective answer;
  grpc::Status status;
};

Synchronizer::Synchronizer(std::shared_ptr<grpc::Channel> channel, const Endpoint& endpoint, WorkerState self,
                           SharedWorkload& workload, ActivityMeter& meter, Prefetcher& prefetcher,
                           std::function<void(Error)> on_refusal)
    : channel_(std::move(channel)),
      self_(std::move(self)),
      workload_(workload),
      meter_(meter),
      prefetcher_(prefetcher),
      on_refusal_(std::move(on_refusal)),
      backoff_(Number(self_.worker)),
      join_backoff_(Number(self_.worker), kJoinAgainFirst, kJoinAgainMax),
      next_call_(Clock::now()),
      next_retry_(next_call_),
      outage_(endpoint) {}

// gRPC calls back once for every call, so wait for that.
Synchronizer::~Synchronizer() {
  for (const auto& call : open_) call->context.TryCancel();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return finished_.size() == open_.size(); });
}

void Synchronizer::NotifyNews() {
  {
    const std::lock_guard lock(mutex_);
    news_ = true;
  }
  changed_.notify_all();
}

void Synchronizer::Start() {
  auto owned = std::make_unique<Call>();
  Call* const call = owned.get();
  WorkerState state = self_;
  state.sequence = call->sequence = ++self_.sequence;
  workload_.FillState(state);
  // The first answer comes immediately: it shows that the coordinator is there and admits this worker.
  if (!connected_) state.wait = {};
  meter_.Fill(state, Clock::now());
  state.memory_bytes = ResidentMemory();
  call->returned = state.returned_leases;
  Write(state, call->request);
  SetDeadline(call->context, state.wait + kAnswerPatience);
  call->stub = proto::Work::NewStub(channel_);
  open_.push_back(std::move(owned));
  call->stub->async()->Synchronize(&call->context, &call->request, &call->answer,
                                   [this, call](grpc::Status status) {
                                     const std::lock_guard lock(mutex_);
                                     call->status = std::move(status);
                                     finished_.push_back(call);
                                     changed_.notify_all();  // under the lock: the destructor waits for this
                                   });
}

std::chrono::steady_clock::time_point Synchronizer::NextWakeup() const {
  // While a call is open, the next is not due before its answer; this is only an upper bound.
  return open_.empty() ? std::max(next_call_, next_retry_)
                       : Clock::now() + kSynchronizeWaitMax + kAnswerPatience;
}

void Synchronizer::Run(std::stop_token stop) {
  while (!stop.stop_requested()) {
    bool news = false;
    std::deque<Call*> finished;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_until(lock, stop, NextWakeup(),
                          [&] { return !finished_.empty() || (news_ && open_.size() < kOpenCallsMax); });
      finished.swap(finished_);
      news = std::exchange(news_, false);
    }
    for (Call* const done : finished) {
      const auto at = std::ranges::find(open_, done, [](const auto& each) { return each.get(); });
      const std::unique_ptr<Call> call = std::move(*at);
      open_.erase(at);
      Handle(*call);
    }
    const auto now = Clock::now();
    const bool due = open_.empty() ? news || now >= next_call_ : news && open_.size() < kOpenCallsMax;
    if (!stop.stop_requested() && due && now >= next_retry_) Start();
  }
}

void Synchronizer::Handle(const Call& call) {
  if (call.status.ok()) return HandleDirective(call);
  if (IsRefusal(call.status)) return on_refusal_(ToError(call.status, "join the farm"));
  if (connected_) spdlog::warn("disconnected reason={}", LogText(call.status.error_message()));
  connected_ = false;
  if (call.status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED) {
    outage_.Postponed(call.status, Clock::now());
    next_retry_ = Clock::now() + join_backoff_.Next();
  } else {
    outage_.Failed(call.status, Clock::now());
    next_retry_ = Clock::now() + backoff_.Next();
  }
}

void Synchronizer::HandleDirective(const Call& call) {
  auto directive = ReadWorkerDirective(call.answer);
  if (!directive) return on_refusal_(Failed(directive.error().message));
  if (!connected_)
    spdlog::info("connected worker={:016x} farm={}", Number(self_.worker), directive->farm.Hex());
  connected_ = true;
  outage_.Ended();
  backoff_.Reset();
  join_backoff_.Reset();
  workload_.Change()->ReturnsAcknowledged(call.returned);
  // The answer to a call that a later one has overtaken may hold leases, but its orders are out of date.
  if (call.sequence != self_.sequence) return workload_.Change()->ApplyOvertaken(*directive, Clock::now());
  if (directive->notice != notice_) {
    notice_ = directive->notice;
    spdlog::warn("notice text={}", LogText(notice_));
  }
  next_call_ = Clock::now() + std::min(directive->call_again, kCallAgainMax);
  if (!directive->prefetch.empty()) prefetcher_.Request(directive->prefetch);
  workload_.Change()->Apply(*directive, Clock::now());
}

void Synchronizer::Leave(std::chrono::milliseconds patience) {
  WorkerState state = self_;
  state.sequence = ++self_.sequence;
  workload_.FillState(state);
  meter_.Fill(state, Clock::now());
  state.memory_bytes = ResidentMemory();
  state.draining = true;
  state.leaving = true;
  state.wait = {};
  proto::WorkerState request;
  Write(state, request);
  proto::WorkerDirective answer;
  grpc::ClientContext context;
  SetDeadline(context, patience);
  const grpc::Status status = proto::Work::NewStub(channel_)->Synchronize(&context, request, &answer);
  spdlog::info("left_farm acknowledged={}", status.ok());
}

}  // namespace tessera
