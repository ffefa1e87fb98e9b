#include "coordinator/core/fact.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include "coordinator/core/byte_codec.h"
#include "coordinator/core/job_codec.h"
#include "coordinator/core/membership_fact_codec.h"

namespace tessera {
namespace {

// Any time that a clock shows: differences of such times cannot overflow.
constexpr int64_t kTimeMax_ms = int64_t{1} << 50;
constexpr double kSecondsMax = 1e15;
constexpr bool IsTimeOfJob(int64_t time_ms) {
  return time_ms >= -kTimeMax_ms && time_ms <= kTimeMax_ms;
}

void Add(ByteWriter& out, const JobSubmitted& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobSubmitted));
  out.Add64(Number(fact.job));
  AddJobSpec(out, *fact.spec);
}

void Add(ByteWriter& out, const JobOrdered& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobOrdered));
  out.Add64(Number(fact.job));
  AddJobOrder(out, *fact.order);
}

void Add(ByteWriter& out, const CoordinatorStarted& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kCoordinatorStarted));
  out.Add32(fact.epoch);
  out.Add64(fact.farm.high);
  out.Add64(fact.farm.low);
}

void Add(ByteWriter& out, const FrameFinished& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kFrameFinished));
  out.Add64(Number(fact.job));
  out.Add32(fact.frame);
  AddDigest(out, fact.file.digest);
  out.Add64(fact.samples);
  out.Add64(fact.file.bytes);
}

void Add(ByteWriter& out, const FrameFailed& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kFrameFailed));
  out.Add64(Number(fact.job));
  out.Add32(fact.frame);
  out.AddText(fact.reason);
}

void Add(ByteWriter& out, const JobEnded& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobEnded));
  out.Add64(Number(fact.job));
  out.Add32(static_cast<uint32_t>(fact.state));
  out.AddText(fact.reason);
}

void Add(ByteWriter& out, const JobExtended& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobExtended));
  out.Add64(Number(fact.job));
  out.Add32(fact.samples_per_pixel);
}

void Add(ByteWriter& out, const JobsForgotten& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobsForgotten));
  out.Add64(Number(fact.last));
}

void Add(ByteWriter& out, const FrameResumed& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kFrameResumed));
  out.Add64(Number(fact.job));
  out.Add32(fact.frame);
}

void Add(ByteWriter& out, const JobPaused& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobPaused));
  out.Add64(Number(fact.job));
  out.Add32(fact.paused ? 1 : 0);
}

void Add(ByteWriter& out, const JobPriorityChanged& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobPriorityChanged));
  out.Add64(Number(fact.job));
  out.Add32(static_cast<uint32_t>(fact.priority));
}

void Add(ByteWriter& out, const WorkerQuarantined& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kWorkerQuarantined));
  out.Add64(Number(fact.worker));
  out.AddText(fact.name);
  out.Add32(fact.drained ? 1 : 0);
  out.AddText(fact.quarantine);
}

void Add(ByteWriter& out, const VoteRecorded& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kVoteRecorded));
  out.Add64(Number(fact.unit.job));
  for (const uint32_t value :
       {fact.unit.frame, fact.unit.tile, fact.unit.range.begin, fact.unit.range.size}) {
    out.Add32(value);
  }
  out.Add64(Number(fact.worker));
  out.AddText(fact.name);
  AddDigest(out, fact.result);
  out.Add64(fact.machine);
}

void Add(ByteWriter& out, const UnitsCounted& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kUnitsCounted));
  out.Add64(Number(fact.job));
  out.Add64(fact.verified);
  out.Add64(fact.disputed);
  out.Add64(fact.suspect);
}

void Add(ByteWriter& out, const JobOwned& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobOwned));
  out.Add64(Number(fact.job));
  out.Add64(Number(fact.owner.member));
  out.AddText(fact.owner.name);
}

// The parts of JobTimes, in the order in which they are written.
constexpr double JobTimes::*kTimes[] = {&JobTimes::render_s, &JobTimes::waste_s,   &JobTimes::other_s,
                                        &JobTimes::fetch_s,  &JobTimes::load_s,    &JobTimes::idle_s,
                                        &JobTimes::tail_s,   &JobTimes::writing_s, &JobTimes::overhead_s,
                                        &JobTimes::merge_s,  &JobTimes::journal_s, &JobTimes::picture_s};
static_assert(std::size(kTimes) * sizeof(double) == sizeof(JobTimes));

void Add(ByteWriter& out, const JobTimed& fact) {
  out.Add32(static_cast<uint32_t>(FactKind::kJobTimed));
  out.Add64(Number(fact.job));
  out.Add64(static_cast<uint64_t>(fact.began_ms));
  out.Add32(fact.ended_ms ? 1 : 0);
  if (!fact.ended_ms) return;
  out.Add64(static_cast<uint64_t>(*fact.ended_ms));
  // In this order: what is not a number becomes 0.
  for (const auto part : kTimes)
    out.Add64(std::bit_cast<uint64_t>(std::min(std::max(0.0, fact.times.*part), kSecondsMax)));
}

std::optional<Fact> ReadJobTimed(ByteReader& in) {
  JobTimed fact;
  fact.job = JobId{in.Read64()};
  fact.began_ms = static_cast<int64_t>(in.Read64());
  const uint32_t has_ended = in.Read32();
  if (has_ended > 1 || !IsTimeOfJob(fact.began_ms)) return std::nullopt;
  if (has_ended == 0) return fact;
  fact.ended_ms = static_cast<int64_t>(in.Read64());
  if (!IsTimeOfJob(*fact.ended_ms)) return std::nullopt;
  for (const auto part : kTimes) {
    fact.times.*part = std::bit_cast<double>(in.Read64());
    if (!(fact.times.*part >= 0 && fact.times.*part <= kSecondsMax)) return std::nullopt;
  }
  return fact;
}

std::optional<Fact> ReadJobOrdered(ByteReader& in) {
  const JobId job{in.Read64()};
  JobOrder order;
  if (!ReadJobOrder(in, order)) return std::nullopt;
  return JobOrdered{job, std::make_shared<const JobOrder>(std::move(order))};
}

CoordinatorStarted ReadCoordinatorStarted(ByteReader& in) {
  CoordinatorStarted fact;
  fact.epoch = in.Read32();
  fact.farm.high = in.Read64();
  fact.farm.low = in.Read64();
  return fact;
}

std::optional<Fact> ReadWorkerQuarantined(ByteReader& in) {
  WorkerQuarantined fact;
  fact.worker = WorkerId{in.Read64()};
  fact.name = in.ReadText();
  const uint32_t drained = in.Read32();
  fact.quarantine = in.ReadText();
  if (drained > 1) return std::nullopt;
  fact.drained = drained == 1;
  return fact;
}

std::optional<Fact> ReadFrameFinished(ByteReader& in, bool has_size) {
  FrameFinished fact;
  fact.job = JobId{in.Read64()};
  fact.frame = in.Read32();
  if (!ReadDigest(in, fact.file.digest)) return std::nullopt;
  fact.samples = in.Read64();
  if (has_size) fact.file.bytes = in.Read64();
  return fact;
}

JobOwned ReadJobOwned(ByteReader& in) {
  JobOwned fact;
  fact.job = JobId{in.Read64()};
  fact.owner.member = MemberId{in.Read64()};
  fact.owner.name = in.ReadText();
  return fact;
}

FrameFailed ReadFrameFailed(ByteReader& in) {
  FrameFailed fact;
  fact.job = JobId{in.Read64()};
  fact.frame = in.Read32();
  fact.reason = in.ReadText();
  return fact;
}

std::optional<Fact> ReadVoteRecorded(ByteReader& in, bool has_machine) {
  VoteRecorded fact;
  fact.unit.job = JobId{in.Read64()};
  for (uint32_t* value : {&fact.unit.frame, &fact.unit.tile, &fact.unit.range.begin, &fact.unit.range.size}) {
    *value = in.Read32();
  }
  fact.worker = WorkerId{in.Read64()};
  fact.name = in.ReadText();
  if (!ReadDigest(in, fact.result) || !fact.unit.range.IsDyadic()) return std::nullopt;
  if (has_machine) fact.machine = in.Read64();
  return fact;
}

std::optional<Fact> ReadFact(ByteReader& in) {
  const auto kind = static_cast<FactKind>(in.Read32());
  switch (kind) {
    case FactKind::kCoordinatorStartedUnnamed: return CoordinatorStarted{in.Read32()};
    case FactKind::kCoordinatorStarted: return ReadCoordinatorStarted(in);
    case FactKind::kJobSubmittedByNames:
    case FactKind::kJobSubmitted: {
      const JobId job{in.Read64()};
      JobSpec spec;
      if (!(kind == FactKind::kJobSubmitted ? ReadJobSpec(in, spec) : ReadJobSpecByNames(in, spec)))
        return std::nullopt;
      return JobSubmitted{job, std::make_shared<const JobSpec>(std::move(spec))};
    }
    case FactKind::kJobOrdered: return ReadJobOrdered(in);
    case FactKind::kJobTimed: return ReadJobTimed(in);
    case FactKind::kFrameFinishedWithoutSize:
    case FactKind::kFrameFinished: return ReadFrameFinished(in, kind == FactKind::kFrameFinished);
    case FactKind::kFrameFailed: return ReadFrameFailed(in);
    case FactKind::kJobEnded: {
      JobEnded fact;
      fact.job = JobId{in.Read64()};
      fact.state = static_cast<JobState>(in.Read32());
      fact.reason = in.ReadText();
      if (fact.state != JobState::kFinished && fact.state != JobState::kFailed &&
          fact.state != JobState::kCancelled) {
        return std::nullopt;
      }
      return fact;
    }
    case FactKind::kJobExtended: {
      JobExtended fact;
      fact.job = JobId{in.Read64()};
      fact.samples_per_pixel = in.Read32();
      if (fact.samples_per_pixel < 1 || fact.samples_per_pixel > kSamplesPerPixelMax) return std::nullopt;
      return fact;
    }
    case FactKind::kJobsForgotten: return JobsForgotten{JobId{in.Read64()}};
    case FactKind::kFrameResumed: {
      const JobId job{in.Read64()};
      return FrameResumed{job, in.Read32()};
    }
    case FactKind::kJobPaused: {
      const JobId job{in.Read64()};
      const uint32_t paused = in.Read32();
      if (paused > 1) return std::nullopt;
      return JobPaused{job, paused == 1};
    }
    case FactKind::kJobPriorityChanged: {
      const JobId job{in.Read64()};
      const auto priority = static_cast<int32_t>(in.Read32());
      if (priority < -kPriorityMax || priority > kPriorityMax) return std::nullopt;
      return JobPriorityChanged{job, priority};
    }
    case FactKind::kWorkerQuarantined: return ReadWorkerQuarantined(in);
    case FactKind::kVoteRecordedWithoutMachine:
    case FactKind::kVoteRecorded: return ReadVoteRecorded(in, kind == FactKind::kVoteRecorded);
    case FactKind::kUnitsCounted: {
      UnitsCounted fact;
      fact.job = JobId{in.Read64()};
      fact.verified = in.Read64();
      fact.disputed = in.Read64();
      fact.suspect = in.Read64();
      return fact;
    }
    case FactKind::kJobOwned: return ReadJobOwned(in);
    default: return ReadMembershipFact(kind, in);
  }
}

}  // namespace

bool FreesSpace(const Fact& fact) {
  const auto* const ended = std::get_if<JobEnded>(&fact);
  return ended != nullptr && ended->state != JobState::kFinished;
}

std::string EncodeFact(const Fact& fact) {
  ByteWriter out;
  std::visit([&](const auto& each) { Add(out, each); }, fact);
  return out.Take();
}

Result<Fact> DecodeFact(std::string_view bytes) {
  ByteReader in(bytes);
  auto fact = ReadFact(in);
  if (!fact || !in.ok() || !in.at_end()) return Failed("a fact of an unknown kind or format");
  return std::move(*fact);
}

}  // namespace tessera
