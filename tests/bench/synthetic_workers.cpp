#include "tests/bench/synthetic_workers.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "proto/probe.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/work.grpc.pb.h"
#include "renderer/film/radiance_tile.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::milliseconds kWait{1000};  // of a state in the coordinator
constexpr size_t kResultsPerCall = 16;

// Made-up values, the same for every tile: what they are makes no difference to who merges them. Sets of ids
// have two entries, as at an edge.
RadianceTile MakeTile(const Lease& lease, const PixelShape& shape) {
  RadianceTile tile;
  tile.bounds = lease.bounds;
  tile.range = lease.unit.range;
  tile.shape = shape;
  const size_t stride = shape.stride();
  const size_t records = static_cast<size_t>(lease.bounds.area()) * stride;
  const auto samples = static_cast<float>(lease.unit.range.size);
  tile.sums.resize(records);
  for (size_t i = 0; i < records; ++i) {
    const bool is_set_size = i % stride >= size_t{shape.sums} + shape.nearest;
    tile.sums[i] = is_set_size ? 2.0f : samples * (0.1f + static_cast<float>(i % 97) * 0.01f);
  }
  for (size_t set = 0; set < static_cast<size_t>(lease.bounds.area()) * shape.id_sets; ++set)
    tile.sums.insert(tile.sums.end(), {1.5f, samples * 0.75f, 2.5f, samples * 0.25f});
  return tile;
}

}  // namespace

struct SyntheticWorkers::Shared {
  std::atomic<uint64_t> results{0}, accepted{0}, bytes{0}, calls{0};
  std::mutex mutex;  // of what follows
  std::condition_variable idle;
  bool closing = false;
  int calls_open = 0;
  std::string error;

  // Whether another call may begin.
  bool BeginCall() {
    const std::lock_guard lock(mutex);
    if (closing) return false;
    ++calls_open;
    return true;
  }
  void EndCall(const grpc::Status& status) {
    const std::lock_guard lock(mutex);
    if (!status.ok() && !IsTransient(status) && !closing && error.empty()) error = status.error_message();
    --calls_open;
    idle.notify_all();
  }
};

// Its two conversations go on by themselves, each from the end of one call to the begin of the next, on
// gRPC's threads.
class SyntheticWorkers::One {
 public:
  One(Shared& shared, const Endpoint& coordinator, int index, int slots, double unit_seconds,
      const PixelShape& shape)
      : shared_(shared),
        channel_(OpenChannel(coordinator)),
        stub_(proto::Work::NewStub(channel_)),
        unit_seconds_(unit_seconds),
        shape_(shape) {
    state_.worker = WorkerId{static_cast<uint64_t>(index) + 1};
    state_.name = fmt::format("synthetic-{}", index);
    state_.slots = slots;
    state_.software_version = kSoftwareVersion;
    const Digest probe = *Digest::FromHex(kProbeDigest);
    state_.probe_digest.assign(probe.bytes.begin(), probe.bytes.end());
    state_.wait = kWait;
  }

  void Start() { Synchronize(); }

 private:
  struct StateCall {
    grpc::ClientContext context;
    proto::WorkerState request;
    proto::WorkerDirective answer;
  };
  // Deletes itself when the call is over.
  class ResultsCall final : public grpc::ClientWriteReactor<proto::ResultsRequest> {
   public:
    ResultsCall(One& one, std::vector<Lease> sent, proto::ResultsRequest results)
        : one_(one), sent_(std::move(sent)), results_(std::move(results)) {
      announcement_ = Announcement(one_.state_.worker, one_.farm(), results_);
      context_.set_wait_for_ready(true);
      SetDeadline(context_, kPatience);
      one_.stub_->async()->ReturnResults(&context_, &answer_, this);
      StartWrite(&announcement_);
      StartCall();
    }

   private:
    void OnWriteDone(bool ok) override {
      if (ok && !std::exchange(is_sent_, true)) StartWriteLast(&results_, {});
    }
    void OnDone(const grpc::Status& status) override {
      if (status.ok()) {
        one_.Answered(answer_, sent_);
      } else if (IsTransient(status)) {
        one_.SendAgain(sent_);
      }
      Shared& shared = one_.shared_;
      delete this;  // first: it holds its channel, which this thread must not be the last to let go
      shared.EndCall(status);
    }

    One& one_;
    std::vector<Lease> sent_;
    grpc::ClientContext context_;
    proto::ResultsRequest announcement_, results_;
    proto::ResultsAnswer answer_;
    bool is_sent_ = false;
  };

  void Synchronize() {
    if (!shared_.BeginCall()) return;
    const auto call = new StateCall;  // deletes itself when it is over
    {
      const std::lock_guard lock(mutex_);
      ++state_.sequence;
      state_.leases.clear();
      for (const auto& [id, lease] : held_)
        state_.leases.push_back({id, lease.unit, LeaseStage::kRunning, {}});
      Write(state_, call->request);
    }
    call->context.set_wait_for_ready(true);  // a thousand at once are more than it takes at once
    SetDeadline(call->context, kWait + kPatience);
    stub_->async()->Synchronize(&call->context, &call->request, &call->answer,
                                [this, call](grpc::Status status) {
                                  if (status.ok()) {
                                    Apply(call->answer);
                                    Return();
                                  }
                                  if (status.ok() || IsTransient(status)) Synchronize();
                                  delete call;  // first, as above
                                  shared_.EndCall(status);
                                });
  }

  FarmId farm() {
    const std::lock_guard lock(mutex_);
    return state_.farm;
  }

  // Every scene is in memory at once.
  void Apply(const proto::WorkerDirective& directive) {
    const std::lock_guard lock(mutex_);
    if (const auto farm = ReadFarmId(directive.farm())) state_.farm = *farm;
    if (directive.scenes_size() > 0) state_.scenes.clear();
    for (const proto::SceneRequest& message : directive.scenes()) {
      const auto order = ReadSceneOrder(message);
      if (order) state_.scenes.push_back({order->key, true});
    }
    Take(directive.leases());
  }

  void Take(const google::protobuf::RepeatedPtrField<proto::Lease>& messages) {
    for (const proto::Lease& message : messages) {
      const auto lease = ReadLease(message);
      if (lease && held_.emplace(lease->id, *lease).second) waiting_.push_back(*lease);
    }
  }

  // Sends what is there, one call at a time.
  void Return() {
    proto::ResultsRequest results;
    std::vector<Lease> sent;
    {
      const std::lock_guard lock(mutex_);
      if (is_returning_ || waiting_.empty()) return;
      if (!shared_.BeginCall()) return;
      is_returning_ = true;
      for (; !waiting_.empty() && sent.size() < kResultsPerCall; waiting_.pop_front()) {
        AddResult(waiting_.front(), results);
        sent.push_back(waiting_.front());
      }
    }
    new ResultsCall(*this, std::move(sent), std::move(results));
  }

  void AddResult(const Lease& lease, proto::ResultsRequest& request) {
    proto::UnitResult& result = *request.add_results();
    Write(lease.id, *result.mutable_lease());
    Write(lease.unit, *result.mutable_unit());
    result.set_tile(EncodeRadianceTile(MakeTile(lease, shape_)));
    result.set_render_seconds(unit_seconds_ * lease.unit.range.size);
    shared_.bytes += result.tile().size();
  }

  void SendAgain(const std::vector<Lease>& sent) {
    {
      const std::lock_guard lock(mutex_);
      is_returning_ = false;
      waiting_.insert(waiting_.end(), sent.begin(), sent.end());
    }
    Return();
  }

  void Answered(const proto::ResultsAnswer& answer, const std::vector<Lease>& sent) {
    {
      const std::lock_guard lock(mutex_);
      is_returning_ = false;
      for (const Lease& lease : sent) held_.erase(lease.id);
      Take(answer.leases());
    }
    ++shared_.calls;
    shared_.results += sent.size();
    for (const int verdict : answer.verdicts())
      shared_.accepted += verdict == proto::ResultsAnswer::ACCEPTED ? 1 : 0;
    Return();
  }

  Shared& shared_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<proto::Work::Stub> stub_;
  const double unit_seconds_;
  const PixelShape shape_;
  std::mutex mutex_;  // of what follows
  WorkerState state_;
  std::map<LeaseId, Lease> held_;
  std::deque<Lease> waiting_;
  bool is_returning_ = false;
};

SyntheticWorkers::SyntheticWorkers(const Endpoint& coordinator, int count, int slots, double unit_seconds,
                                   const PixelShape& shape)
    : shared_(std::make_unique<Shared>()) {
  for (int i = 0; i < count; ++i)
    all_.push_back(std::make_unique<One>(*shared_, coordinator, i, slots, unit_seconds, shape));
  for (const auto& one : all_) one->Start();
}

SyntheticWorkers::~SyntheticWorkers() {
  std::unique_lock lock(shared_->mutex);
  shared_->closing = true;
  shared_->idle.wait(lock, [this] { return shared_->calls_open == 0; });
}

LoadCounts SyntheticWorkers::counts() const {
  return {shared_->results, shared_->accepted, shared_->bytes, shared_->calls};
}

std::string SyntheticWorkers::error() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->error;
}

}  // namespace tessera
