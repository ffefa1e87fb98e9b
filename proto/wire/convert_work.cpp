// Conversions of the conversation with workers.
#include "proto/wire/convert.h"
#include "proto/wire/fields.h"
#include "proto/work.pb.h"
#include "renderer/film/radiance_tile.h"

namespace tessera {
namespace {

Result<HeldLease> ReadHeldLease(const proto::HeldLease& message) {
  const auto unit = ReadWorkUnit(message.unit());
  if (!unit) return unit.error();
  HeldLease held{ReadLeaseId(message.lease()), *unit, LeaseStage::kWaiting,
                 std::chrono::milliseconds(message.stage_ms())};
  switch (message.stage()) {
    case proto::HeldLease::WAITING: held.stage = LeaseStage::kWaiting; break;
    case proto::HeldLease::RUNNING: held.stage = LeaseStage::kRunning; break;
    case proto::HeldLease::RETURNING: held.stage = LeaseStage::kReturning; break;
    default: return BadField("stage", "is unknown");
  }
  return held;
}

proto::HeldLease::Stage WriteStage(LeaseStage stage) {
  switch (stage) {
    case LeaseStage::kWaiting: return proto::HeldLease::WAITING;
    case LeaseStage::kRunning: return proto::HeldLease::RUNNING;
    case LeaseStage::kReturning: return proto::HeldLease::RETURNING;
  }
  TESSERA_CHECK(false);
}

proto::HeldScene::State WriteSceneState(const HeldScene& scene) {
  if (scene.ready) return proto::HeldScene::READY;
  return scene.fetching ? proto::HeldScene::FETCHING : proto::HeldScene::LOADING;
}

WorkerActivity ReadActivity(const proto::WorkerActivity& message) {
  constexpr uint64_t kMost = uint64_t{1} << 52;  // beyond any process's life; keeps arithmetic exact
  const auto read = [=](uint64_t value) { return std::min(value, kMost); };
  return {read(message.busy_ms()), read(message.fetching_ms()), read(message.loading_ms()),
          read(message.idle_ms()), read(message.bytes_fetched())};
}

void Write(const WorkerActivity& value, proto::WorkerActivity& message) {
  message.set_busy_ms(value.busy_ms);
  message.set_fetching_ms(value.fetching_ms);
  message.set_loading_ms(value.loading_ms);
  message.set_idle_ms(value.idle_ms);
  message.set_bytes_fetched(value.bytes_fetched);
}

Result<void> CheckIdentity(const proto::WorkerState& message) {
  if (message.worker() == 0) return BadField("worker", "is missing");
  if (message.slots() < 1 || message.slots() > static_cast<uint32_t>(kSlotsMax)) {
    return BadField("slots", "is not a number of render threads");
  }
  if (message.build_digest().size() > kNameBytesMax) return BadField("build_digest", "is too long");
  if (message.probe_digest().size() > kNameBytesMax) return BadField("probe_digest", "is too long");
  if (message.scenes_size() > kScenesPerWorkerMax) return BadField("scenes", "are too many");
  if (message.leases_size() > kLeasesPerWorkerMax) return BadField("leases", "are too many");
  if (message.returned_leases_size() > kLeasesPerWorkerMax)
    return BadField("returned_leases", "are too many");
  if (message.preparations_size() > kPreparationsPerWorkerMax)
    return BadField("preparations", "are too many");
  return {};
}

Result<void> ReadHoldings(const proto::WorkerState& message, WorkerState& state) {
  const auto farm = ReadFarmId(message.farm());
  if (!farm) return farm.error();
  state.farm = *farm;
  for (const auto& scene : message.scenes()) {
    const auto key = ReadDigest(scene.scene(), "scene");
    if (!key) return key.error();
    state.scenes.push_back(
        {*key, scene.state() == proto::HeldScene::READY, scene.state() == proto::HeldScene::FETCHING});
  }
  for (const auto& lease : message.leases()) {
    const auto held = ReadHeldLease(lease);
    if (!held) return held.error();
    state.leases.push_back(*held);
  }
  for (const auto& lease : message.returned_leases()) state.returned_leases.push_back(ReadLeaseId(lease));
  for (const std::string& bytes : message.preparations()) {
    const auto key = ReadDigest(bytes, "preparations");
    if (!key) return key.error();
    state.preparations.push_back(*key);
  }
  return {};
}

}  // namespace

Result<WorkerState> ReadWorkerState(const proto::WorkerState& message) {
  if (const auto checked = CheckIdentity(message); !checked) return checked.error();
  WorkerState state;
  state.protocol = message.protocol();
  state.worker = WorkerId{message.worker()};
  state.sequence = message.sequence();
  state.name = CleanName(message.name());
  state.slots = static_cast<int>(message.slots());
  state.software_version = CleanName(message.software_version());
  state.build_digest = message.build_digest();
  state.probe_digest = message.probe_digest();
  state.machine = message.machine();
  auto tags = ReadTags(message.tags(), "tags");
  if (!tags) return tags.error();
  state.tags = std::move(*tags);
  if (state.protocol != kProtocolVersion) return state;
  if (const auto read = ReadHoldings(message, state); !read) return read.error();
  state.draining = message.draining();
  state.leaving = message.leaving();
  state.wait = std::min(std::chrono::milliseconds(message.wait_ms()), kSynchronizeWaitMax);
  state.activity = ReadActivity(message.activity());
  state.memory_bytes = message.memory_bytes();
  return state;
}

void Write(const WorkerState& value, proto::WorkerState& message) {
  message.set_protocol(value.protocol);
  message.set_worker(Number(value.worker));
  message.set_farm(WriteFarmId(value.farm));
  message.set_sequence(value.sequence);
  message.set_name(CleanName(value.name));
  message.set_slots(static_cast<uint32_t>(value.slots));
  message.set_software_version(CleanName(value.software_version));
  message.set_build_digest(value.build_digest);
  message.set_probe_digest(value.probe_digest);
  message.set_machine(value.machine);
  message.set_memory_bytes(value.memory_bytes);
  for (const std::string& tag : value.tags) message.add_tags(tag);
  for (const HeldScene& scene : value.scenes) {
    auto& written = *message.add_scenes();
    written.set_scene(WriteDigest(scene.key));
    written.set_state(WriteSceneState(scene));
  }
  for (const HeldLease& lease : value.leases) {
    auto& written = *message.add_leases();
    Write(lease.id, *written.mutable_lease());
    Write(lease.unit, *written.mutable_unit());
    written.set_stage(WriteStage(lease.stage));
    written.set_stage_ms(static_cast<uint32_t>(lease.stage_duration.count()));
  }
  for (const LeaseId lease : value.returned_leases) Write(lease, *message.add_returned_leases());
  for (const Digest& key : value.preparations) message.add_preparations(WriteDigest(key));
  message.set_draining(value.draining);
  message.set_leaving(value.leaving);
  message.set_wait_ms(static_cast<uint32_t>(value.wait.count()));
  Write(value.activity, *message.mutable_activity());
}

Result<WorkerDirective> ReadWorkerDirective(const proto::WorkerDirective& message) {
  WorkerDirective directive;
  const auto farm = ReadFarmId(message.farm());
  if (!farm) return farm.error();
  directive.farm = *farm;
  if (message.scenes_size() > kScenesPerWorkerMax) return BadField("scenes", "are too many");
  for (const auto& scene : message.scenes()) {
    auto order = ReadSceneOrder(scene);
    if (!order) return order.error();
    directive.scenes.push_back(std::move(*order));
  }
  if (message.leases_size() > kLeasesPerWorkerMax) return BadField("leases", "are too many");
  for (const auto& lease : message.leases()) {
    const auto read = ReadLease(lease);
    if (!read) return read.error();
    directive.leases.push_back(*read);
  }
  for (const auto& lease : message.drop()) directive.drop.push_back(ReadLeaseId(lease));
  if (message.prefetch_size() > kScenesPerWorkerMax) return BadField("prefetch", "are too many");
  for (const std::string& bytes : message.prefetch()) {
    const auto package = ReadDigest(bytes, "prefetch");
    if (!package) return package.error();
    directive.prefetch.push_back(*package);
  }
  if (message.has_preparation()) {
    auto preparation = ReadPreparationRequest(message.preparation());
    if (!preparation) return preparation.error();
    directive.preparation = std::move(*preparation);
  }
  directive.call_again = std::chrono::milliseconds(message.call_again_ms());
  directive.notice = CleanReason(message.notice());
  return directive;
}

void Write(const WorkerDirective& value, proto::WorkerDirective& message) {
  message.set_farm(WriteFarmId(value.farm));
  for (const SceneRequest& scene : value.scenes) Write(scene, *message.add_scenes());
  for (const Lease& lease : value.leases) Write(lease, *message.add_leases());
  for (const LeaseId lease : value.drop) Write(lease, *message.add_drop());
  for (const Digest& package : value.prefetch) message.add_prefetch(WriteDigest(package));
  if (value.preparation) Write(*value.preparation, *message.mutable_preparation());
  message.set_call_again_ms(static_cast<uint32_t>(value.call_again.count()));
  message.set_notice(CleanReason(value.notice));
}

proto::ResultsRequest Announcement(WorkerId worker, FarmId farm, const proto::ResultsRequest& results) {
  proto::ResultsRequest message;
  message.set_worker(Number(worker));
  message.set_farm(WriteFarmId(farm));
  message.set_bytes(results.ByteSizeLong());
  uint64_t decoded_bytes = 0;
  for (const proto::UnitResult& result : results.results()) decoded_bytes += DecodedSize(result.tile());
  message.set_decoded_bytes(decoded_bytes);
  return message;
}

}  // namespace tessera
