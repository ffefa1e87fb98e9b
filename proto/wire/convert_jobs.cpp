// Conversions of the conversation with clients.
#include "proto/jobs.pb.h"
#include "proto/wire/convert.h"
#include "proto/wire/fields.h"

namespace tessera {
namespace {

std::chrono::milliseconds ReadDuration(uint64_t ms) {
  // Beyond the age of anything; keeps arithmetic in range.
  constexpr uint64_t kLongest_ms = uint64_t{1} << 52;
  return std::chrono::milliseconds(static_cast<int64_t>(std::min(ms, kLongest_ms)));
}

// A rate or ratio for people: nothing negative or not finite gets in.
double ReadMeasure(double value) {
  return value >= 0 && value < 1e300 ? value : 0;
}

JobTimes ReadTimes(const proto::JobTimes& message) {
  JobTimes times;
  times.render_s = ReadMeasure(message.render_s());
  times.waste_s = ReadMeasure(message.waste_s());
  times.other_s = ReadMeasure(message.other_s());
  times.fetch_s = ReadMeasure(message.fetch_s());
  times.load_s = ReadMeasure(message.load_s());
  times.idle_s = ReadMeasure(message.idle_s());
  times.tail_s = ReadMeasure(message.tail_s());
  times.writing_s = ReadMeasure(message.writing_s());
  times.overhead_s = ReadMeasure(message.overhead_s());
  times.merge_s = ReadMeasure(message.merge_s());
  times.journal_s = ReadMeasure(message.journal_s());
  times.picture_s = ReadMeasure(message.picture_s());
  return times;
}

void Write(const JobTimes& value, proto::JobTimes& message) {
  message.set_render_s(value.render_s);
  message.set_waste_s(value.waste_s);
  message.set_other_s(value.other_s);
  message.set_fetch_s(value.fetch_s);
  message.set_load_s(value.load_s);
  message.set_idle_s(value.idle_s);
  message.set_tail_s(value.tail_s);
  message.set_writing_s(value.writing_s);
  message.set_overhead_s(value.overhead_s);
  message.set_merge_s(value.merge_s);
  message.set_journal_s(value.journal_s);
  message.set_picture_s(value.picture_s);
}

}  // namespace

Result<int32_t> ReadPriority(int32_t priority) {
  if (priority < -kPriorityMax || priority > kPriorityMax) return BadField("priority", "is beyond a million");
  return priority;
}

Result<JobSpec> ReadJobSpec(const proto::JobSpec& message) {
  JobSpec spec;
  spec.submission = message.submission();
  if (spec.submission == 0) return BadField("submission", "is missing");
  spec.name = CleanName(message.name());
  const auto priority = ReadPriority(message.priority());
  if (!priority) return priority.error();
  spec.priority = *priority;
  const auto package = ReadDigest(message.package(), "package");
  if (!package) return package.error();
  spec.package = *package;
  if (message.frames_size() < 1) return BadField("frames", "are missing");
  if (message.frames_size() > kFramesPerJobMax) return BadField("frames", "are too many for one job");
  for (const auto& frame : message.frames()) {
    auto order = ReadFrameRequest(frame);
    if (!order) return order.error();
    spec.frames.push_back(std::move(*order));
  }
  auto tags = ReadTags(message.required_tags(), "required_tags");
  if (!tags) return tags.error();
  spec.required_tags = std::move(*tags);
  spec.verify_share = message.verify_share();
  if (!IsShare(spec.verify_share)) return BadField("verify_share", "is not from 0 to 1");
  if (!message.has_first()) return spec;
  const proto::Region& first = message.first();
  spec.first = Region{first.x0(), first.x1(), first.y0(), first.y1()};
  if (!IsRegion(*spec.first)) return BadField("first", "is not a part of the picture");
  return spec;
}

void Write(const JobSpec& value, proto::JobSpec& message) {
  message.set_submission(value.submission);
  message.set_name(CleanName(value.name));
  message.set_priority(value.priority);
  message.set_package(WriteDigest(value.package));
  for (const FrameRequest& frame : value.frames) Write(frame, *message.add_frames());
  for (const std::string& tag : value.required_tags) message.add_required_tags(tag);
  message.set_verify_share(value.verify_share);
  if (!value.first) return;
  proto::Region& first = *message.mutable_first();
  first.set_x0(value.first->x0);
  first.set_x1(value.first->x1);
  first.set_y0(value.first->y0);
  first.set_y1(value.first->y1);
}

Result<JobStatus> ReadJobStatus(const proto::JobStatus& message) {
  if (!proto::JobState_IsValid(message.state())) return BadField("state", "is unknown");
  JobStatus status;
  status.job = JobId{message.job()};
  status.name = CleanName(message.name());
  status.priority = message.priority();
  status.state = static_cast<JobState>(message.state());
  status.reason = CleanReason(message.reason());
  status.samples_done = message.samples_done();
  status.samples_total = message.samples_total();
  status.samples_per_second = ReadMeasure(message.samples_per_second());
  status.workers = message.workers();
  status.elapsed = ReadDuration(message.elapsed_ms());
  const int64_t left_ms = message.left_ms();
  status.left = left_ms < 0 ? std::chrono::milliseconds(-1) : ReadDuration(static_cast<uint64_t>(left_ms));
  status.frames_total = message.frames_total();
  status.frames_finished = message.frames_finished();
  status.frames_failed = message.frames_failed();
  status.times = ReadTimes(message.times());
  status.paused_by_user = message.paused_by_user();
  status.verify_share = ReadMeasure(message.verify_share());
  status.units_verified = message.units_verified();
  status.units_disputed = message.units_disputed();
  status.units_suspect = message.units_suspect();
  status.submission = message.submission();
  status.owner = {MemberId{message.owner_member()}, CleanName(message.owner())};
  if (message.has_noise()) status.noise = ReadMeasure(message.noise());
  return status;
}

static_assert(static_cast<int>(JobState::kWaiting) == proto::JOB_STATE_WAITING);
static_assert(static_cast<int>(JobState::kRunning) == proto::JOB_STATE_RUNNING);
static_assert(static_cast<int>(JobState::kPaused) == proto::JOB_STATE_PAUSED);
static_assert(static_cast<int>(JobState::kFinished) == proto::JOB_STATE_FINISHED);
static_assert(static_cast<int>(JobState::kFailed) == proto::JOB_STATE_FAILED);
static_assert(static_cast<int>(JobState::kCancelled) == proto::JOB_STATE_CANCELLED);
static_assert(static_cast<int>(JobState::kPreparing) == proto::JOB_STATE_PREPARING);

void Write(const JobStatus& value, proto::JobStatus& message) {
  message.set_job(Number(value.job));
  message.set_name(CleanName(value.name));
  message.set_priority(value.priority);
  message.set_state(static_cast<proto::JobState>(value.state));
  message.set_reason(CleanReason(value.reason));
  message.set_samples_done(value.samples_done);
  message.set_samples_total(value.samples_total);
  message.set_samples_per_second(value.samples_per_second);
  message.set_workers(value.workers);
  message.set_elapsed_ms(static_cast<uint64_t>(value.elapsed.count()));
  message.set_left_ms(value.left.count());
  message.set_frames_total(value.frames_total);
  message.set_frames_finished(value.frames_finished);
  message.set_frames_failed(value.frames_failed);
  Write(value.times, *message.mutable_times());
  message.set_paused_by_user(value.paused_by_user);
  message.set_verify_share(value.verify_share);
  message.set_units_verified(value.units_verified);
  message.set_units_disputed(value.units_disputed);
  message.set_units_suspect(value.units_suspect);
  message.set_submission(value.submission);
  message.set_owner(CleanName(value.owner.name));
  message.set_owner_member(Number(value.owner.member));
  if (value.noise) message.set_noise(*value.noise);
}

Result<std::vector<FrameStatus>> ReadFrameStatuses(const proto::FramesAnswer& message) {
  if (message.frames_size() < 1) return BadField("frames", "are missing");
  if (message.frames_size() > kFramesPerJobMax) return BadField("frames", "are too many for one job");
  std::vector<FrameStatus> frames;
  for (const auto& frame : message.frames()) {
    frames.push_back({frame.number(), std::nullopt, frame.failed()});
    if (frame.file().empty()) continue;
    const auto file = ReadDigest(frame.file(), "file");
    if (!file) return file.error();
    frames.back().file = *file;
  }
  return frames;
}

void Write(const std::vector<FrameStatus>& value, proto::FramesAnswer& message) {
  for (const FrameStatus& frame : value) {
    auto& written = *message.add_frames();
    written.set_number(frame.number);
    written.set_failed(frame.has_failed);
    if (frame.file) written.set_file(WriteDigest(*frame.file));
  }
}

Result<JobLogPage> ReadJobLog(const proto::JobLogAnswer& message) {
  if (message.entries_size() > static_cast<int>(kLogEntriesPerCallMax))
    return BadField("entries", "are too many for one call");
  JobLogPage page;
  for (const auto& entry : message.entries()) {
    if (entry.level() < 0 || entry.level() > static_cast<int>(kMessageLevelLast))
      return BadField("level", "is unknown");
    page.entries.push_back({entry.number(), entry.unix_time_ms(), static_cast<MessageLevel>(entry.level()),
                            CleanReason(entry.text())});
  }
  page.has_more = message.has_more();
  page.has_ended = message.has_ended();
  return page;
}

void Write(const JobLogPage& value, proto::JobLogAnswer& message) {
  for (const JobLogEntry& entry : value.entries) {
    auto& written = *message.add_entries();
    written.set_number(entry.number);
    written.set_unix_time_ms(entry.unix_time_ms);
    written.set_level(static_cast<proto::MessageLevel>(entry.level));
    written.set_text(CleanReason(entry.text));
  }
  message.set_has_more(value.has_more);
  message.set_has_ended(value.has_ended);
}

Result<WorkerStatus> ReadWorkerStatus(const proto::WorkerStatus& message) {
  if (message.slots() > static_cast<uint32_t>(kSlotsMax)) return BadField("slots", "is beyond the limit");
  WorkerStatus status;
  status.worker = WorkerId{message.worker()};
  status.name = CleanName(message.name());
  status.slots = static_cast<int>(message.slots());
  status.software_version = CleanName(message.software_version());
  status.leases = message.leases();
  status.units_finished = message.units_finished();
  status.units_failed = message.units_failed();
  status.speed = ReadMeasure(message.speed());
  status.silent = ReadDuration(message.silent_ms());
  status.draining = message.draining();
  status.quarantined = message.quarantined();
  status.reason = CleanReason(message.reason());
  status.utilisation = std::min(ReadMeasure(message.utilisation()), 1.0);
  status.samples_per_second = ReadMeasure(message.samples_per_second());
  status.fetching = message.fetching();
  status.loading = message.loading();
  auto tags = ReadTags(message.tags(), "tags");
  if (!tags) return tags.error();
  status.tags = std::move(*tags);
  status.memory_bytes = message.memory_bytes();
  if (message.scenes_size() > static_cast<int>(kScenesShownMax)) return BadField("scenes", "are too many");
  for (const uint64_t job : message.scenes()) status.scenes.push_back(JobId{job});
  status.last_failure = CleanReason(message.last_failure());
  return status;
}

void Write(const WorkerStatus& value, proto::WorkerStatus& message) {
  message.set_worker(Number(value.worker));
  message.set_name(CleanName(value.name));
  message.set_slots(static_cast<uint32_t>(value.slots));
  message.set_software_version(CleanName(value.software_version));
  message.set_leases(value.leases);
  message.set_units_finished(value.units_finished);
  message.set_units_failed(value.units_failed);
  message.set_speed(value.speed);
  message.set_silent_ms(static_cast<uint64_t>(value.silent.count()));
  message.set_draining(value.draining);
  message.set_quarantined(value.quarantined);
  message.set_reason(CleanReason(value.reason));
  message.set_utilisation(value.utilisation);
  message.set_samples_per_second(value.samples_per_second);
  message.set_fetching(value.fetching);
  message.set_loading(value.loading);
  for (const std::string& tag : value.tags) message.add_tags(tag);
  message.set_memory_bytes(value.memory_bytes);
  for (const JobId job : value.scenes) message.add_scenes(Number(job));
  message.set_last_failure(CleanReason(value.last_failure));
}

}  // namespace tessera
