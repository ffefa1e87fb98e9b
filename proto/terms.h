// The plain values that client, coordinator and worker share. No gRPC and no protobuf: those are in wire/.
// Values that come from outside are checked when they are read (wire/convert.h), so the limits here hold.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "proto/membership.h"
#include "proto/scene_order.h"
#include "renderer/film/frame_spec.h"
#include "renderer/film/pixel_mask.h"
#include "renderer/film/sample_range.h"
#include "renderer/util/digest.h"
#include "renderer/util/release.h"

namespace tessera {

constexpr uint32_t kProtocolVersion = 8;  // counts changes that older programs would misread
constexpr const char* kSoftwareVersion = kRelease;

constexpr int kFramesPerJobMax = 10'000;                // of one job: its specs fit into one message
constexpr int64_t kResultBytesMax = int64_t{16} << 20;  // of one unit's radiance tile
// Of the sums and the picture of one frame in the memory of a coordinator: 16k x 16k pixels in colour.
constexpr int64_t kFrameBytesMax = int64_t{8} << 30;
// Of any message: one result of the largest size fits.
constexpr int64_t kMessageBytesMax = int64_t{24} << 20;
constexpr int64_t kResultsBatchBytes = int64_t{2} << 20;  // results returned in one call, beyond the first
constexpr int kResultsPerCallMax = 256;
// Of blobs and pictures: streams share a connection fairly.
constexpr int64_t kChunkBytesMax = int64_t{1} << 20;
constexpr int kDigestsPerCallMax = 10'000;
constexpr uint64_t kBlobBytesMax = uint64_t{16} << 30;  // beyond any mesh or texture seen
constexpr int kSlotsMax = 1024;  // of one worker process: more than any machine has threads
constexpr int kLeasesPerWorkerMax = 32 * kSlotsMax;  // listed in one state
constexpr int kScenesPerWorkerMax = 256;             // listed in one state
constexpr int kPreparationsPerWorkerMax = 16;        // listed in one state
constexpr int kPreparationWarningsMax = 20;          // of a scene that was prepared
constexpr size_t kNameBytesMax = 256;                // of a job, a worker, a version
constexpr size_t kPathBytesMax = 4096;               // of a file in a package
constexpr size_t kOptionsBytesMax = 64 << 10;        // of encoded render options
constexpr size_t kReasonBytesMax = 4096;             // of messages to users; longer ones are cut
constexpr size_t kAttributesBytesMax = 1 << 20;      // of a frame's EXR header attributes together
constexpr int kPriorityMax = 1'000'000;              // and its negative
constexpr size_t kTagBytesMax = 64;                  // of one word
constexpr size_t kTagsMax = 32;                      // of a worker, or required by a job
// That an answer waits: below any proxy's idle limit.
constexpr std::chrono::milliseconds kSynchronizeWaitMax{10'000};

// A tag names something that not every worker has. It is one word of letters, digits and ". _ - + :".
bool IsTag(std::string_view word);

// From 0 to 1.
constexpr bool IsShare(double value) {
  return value >= 0 && value <= 1;
}

// A part of a picture, as fractions of its width and height.
struct Region {
  float x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  auto operator<=>(const Region&) const = default;
};
// Whether 0 <= x0 < x1 <= 1, and the same for y.
bool IsRegion(const Region& region);
// The pixels that the region touches, of the whole picture.
PixelBounds PixelsOf(const Region& region, const FrameSpec& frame);
bool Overlap(const PixelBounds& a, const PixelBounds& b);

enum class JobId : uint64_t {};     // counted from 1 per data directory
enum class WorkerId : uint64_t {};  // random, chosen by the worker process

// Names a farm: drawn at random when its data directory is made.
struct FarmId {
  uint64_t high = 0, low = 0;  // both 0: no farm
  auto operator<=>(const FarmId&) const = default;
  std::string Hex() const;  // 32 hexadecimal digits
};

// Never used twice by any coordinator: each of its processes draws a session at random. Numbers of later
// leases of a data directory are larger.
struct LeaseId {
  uint64_t number = 0, session = 0;  // both 0: no lease
  auto operator<=>(const LeaseId&) const = default;
};

constexpr uint64_t Number(JobId id) {
  return static_cast<uint64_t>(id);
}
constexpr uint64_t Number(WorkerId id) {
  return static_cast<uint64_t>(id);
}

// What a worker renders: samples `range` of tile `tile` of frame `frame` (an index) of a job. The job's
// number may be that of another job in another data directory, or in another history of the same one: `scene`
// decides which picture a result may enter.
struct WorkUnit {
  JobId job{};
  uint32_t frame = 0;
  uint32_t tile = 0;
  SampleRange range;
  Digest scene{};  // SceneRequest::key
  auto operator<=>(const WorkUnit&) const = default;
  std::string Text() const;  // "job 3 frame 0 tile 17 samples [64,128)"
};

// Permission to render a unit. The worker should return its result within `duration` of receiving the lease,
// or report that it still holds it.
struct Lease {
  LeaseId id{};
  WorkUnit unit;
  PixelBounds bounds;
  PixelMask pixels;  // those of the bounds to be rendered
  std::chrono::milliseconds duration{};
};

// A scene to load: package, scene file, options and the frame that they must give. Jobs with the same four
// share it.
struct SceneRequest {
  Digest key;  // SceneKey(package, scene_file, options, frame)
  Digest package;
  std::string scene_file;
  std::string options;  // EncodeRenderOptions
  FrameSpec frame;
  bool needs_all = false;  // the scene uses every file of the package
};
// The SHA-256 of all that decides the pixels of a frame.
Digest SceneKey(const Digest& package, const std::string& scene_file, const std::string& options,
                const FrameSpec& frame);

enum class LeaseStage { kWaiting, kRunning, kReturning };
struct HeldLease {
  LeaseId id{};
  WorkUnit unit;
  LeaseStage stage = LeaseStage::kWaiting;
  std::chrono::milliseconds stage_duration{};
};

struct HeldScene {
  Digest key;
  bool ready = false;     // otherwise still loading
  bool fetching = false;  // while loading: its files are being fetched
};

// What the slots of a worker process have done since it started, in slot-milliseconds. The values only grow,
// so nothing is lost with a message.
struct WorkerActivity {
  uint64_t busy_ms = 0;      // rendering
  uint64_t fetching_ms = 0;  // waiting while the worker fetches the files of a scene
  uint64_t loading_ms = 0;   // waiting while the worker reads and builds a scene
  uint64_t idle_ms = 0;      // without anything to do
  uint64_t bytes_fetched = 0;
};

// What a worker is and does, as it reports.
struct WorkerState {
  uint32_t protocol = kProtocolVersion;
  WorkerId worker{};
  FarmId farm;            // of which the leases are
  MemberId member{};      // whose certificate it has; 0: none. The coordinator sets it
  uint64_t sequence = 0;  // of Synchronize calls
  std::string name;       // for people; of a member, the name in the farm's list of members
  int slots = 1;
  std::string software_version = kSoftwareVersion;
  std::string build_digest;  // raw bytes; may be empty
  std::string probe_digest;  // raw bytes
  uint64_t machine = 0;      // the same for all workers on it; 0: not known
  std::set<std::string> tags;
  std::vector<HeldScene> scenes;
  std::vector<HeldLease> leases;
  std::vector<LeaseId> returned_leases;
  std::vector<Digest> preparations;  // by their keys: to be done, being done, or to be reported
  bool draining = false;
  bool leaving = false;
  WorkerActivity activity;
  uint64_t memory_bytes = 0;  // of its process, resident; 0: not known
  std::chrono::milliseconds wait{};
};

// What a worker should hold and do; proto/work.proto has the rules.
struct WorkerDirective {
  std::vector<SceneRequest> scenes;
  std::vector<Lease> leases;
  std::vector<LeaseId> drop;
  std::vector<Digest> prefetch;  // packages
  std::optional<PreparationRequest> preparation;
  std::chrono::milliseconds call_again{};
  std::string notice;
  FarmId farm{};
};

// What became of a returned result.
enum class Verdict { kAccepted, kDuplicate, kObsolete, kRefused };

struct FrameRequest {
  std::string scene_file;
  std::string options;  // EncodeRenderOptions
  FrameSpec spec;
  int32_t number = 0;
  bool extendable = false;  // its samples do not depend on their number
};

// What a client submits. Immutable once accepted.
struct JobSpec {
  uint64_t submission = 0;
  std::string name;
  int32_t priority = 0;
  Digest package;
  std::vector<FrameRequest> frames;
  std::set<std::string> required_tags;  // only workers with all of them render its units
  double verify_share = 0;              // share of its units that two workers render; IsShare
  std::optional<Region> first;          // of each frame: rendered before the rest; IsRegion
};

// What a client submits that cannot read scenes: a worker makes the frames of the job. Immutable once
// accepted.
struct JobOrder {
  uint64_t submission = 0;
  std::string name;
  int32_t priority = 0;
  SceneOrder scene;
};
// The SHA-256 of all of it.
Digest PreparationKey(const JobOrder& order);

// What became of a preparation.
struct PreparationReport {
  Digest key;
  std::vector<FrameRequest> frames;
  std::vector<std::string> warnings;  // of the scenes; at most kPreparationWarningsMax
  std::string reason;                 // why there are no frames
  FarmId farm{};                      // whose preparation it is
};

// kPreparing: a worker makes the frames of the job.
enum class JobState { kWaiting, kRunning, kPaused, kFinished, kFailed, kCancelled, kPreparing };
constexpr JobState kJobStateLast = JobState::kPreparing;
const char* JobStateName(JobState state);  // "waiting", "running", ...
constexpr bool HasEnded(JobState state) {
  return state == JobState::kFinished || state == JobState::kFailed || state == JobState::kCancelled;
}

// Where the time of the farm went while a job was open, in slot-seconds. The parts add up to the whole.
struct JobTimes {
  double render_s = 0;    // rendering what is in the picture
  double waste_s = 0;     // rendering what others returned earlier, or what was dropped or lost
  double other_s = 0;     // rendering other jobs
  double fetch_s = 0;     // waiting for scene files
  double load_s = 0;      // waiting for a scene to be read and built
  double idle_s = 0;      // without work while units were waiting to be leased
  double tail_s = 0;      // without work while the last units ran on other slots
  double writing_s = 0;   // without work while pictures were written
  double overhead_s = 0;  // holding a lease and not rendering: messages and everything unmeasured
  double SlotSeconds() const {
    return render_s + waste_s + other_s + fetch_s + load_s + idle_s + tail_s + writing_s + overhead_s;
  }
  // Of the coordinator, not of slots: it does these while the slots render.
  double merge_s = 0, journal_s = 0, picture_s = 0;
};

struct JobStatus {
  JobId job{};
  std::string name;
  JobOwner owner;
  int32_t priority = 0;
  JobState state = JobState::kWaiting;
  std::string reason;  // of kPaused and kFailed; of kWaiting if something it needs is missing
  uint64_t samples_done = 0, samples_total = 0;
  double samples_per_second = 0;
  uint32_t workers = 0;
  std::chrono::milliseconds elapsed{};
  std::chrono::milliseconds left{-1};  // negative: unknown
  uint32_t frames_total = 0, frames_finished = 0, frames_failed = 0;
  // Root of the relMSE that the pictures are expected to have, as --noise-threshold has it; nullopt: not
  // known.
  std::optional<double> noise;
  JobTimes times;
  bool paused_by_user = false;  // otherwise `reason` applies, and the job resumes by itself
  // Verification: the share of units requested, units on which two workers agree, units on which workers
  // disagreed, and units merged from workers found wrong that no other worker has confirmed.
  double verify_share = 0;
  uint64_t units_verified = 0, units_disputed = 0, units_suspect = 0;
  // Of the JobSpec. A data directory that is restored to an earlier state uses numbers of jobs again.
  uint64_t submission = 0;
};

// How much a message to people matters.
enum class MessageLevel { kInfo, kWarning, kError };
constexpr MessageLevel kMessageLevelLast = MessageLevel::kError;
const char* MessageLevelName(MessageLevel level);  // "info", "warning", "error"

// A message of the log of a job.
struct JobLogEntry {
  // Larger for every later entry, also across restarts of the coordinator. Numbers are left out.
  uint64_t number = 0;
  int64_t unix_time_ms = 0;
  MessageLevel level = MessageLevel::kInfo;
  std::string text;
  bool operator==(const JobLogEntry&) const = default;
};

struct JobLogPage {
  std::vector<JobLogEntry> entries;  // oldest first
  bool has_more = false;             // entries after these
  bool has_ended = false;            // the job; then no entry follows the last one
};
constexpr size_t kLogEntriesPerCallMax = 1000;

struct FrameStatus {
  int32_t number = 0;          // FrameRequest::number
  std::optional<Digest> file;  // of its EXR file, once it can be fetched
  bool has_failed = false;     // no worker can render it
};

struct WorkerStatus {
  WorkerId worker{};
  std::string name;
  int slots = 0;
  std::string software_version;
  uint32_t leases = 0;
  uint64_t units_finished = 0, units_failed = 0;
  double speed = 1;  // relative to the average
  std::chrono::milliseconds silent{};
  bool draining = false, quarantined = false;
  std::string reason;
  double utilisation = 0;                  // of its slots, over the last minute: 0 to 1
  double samples_per_second = 0;           // over the last minute, accepted
  bool fetching = false, loading = false;  // a scene
  std::set<std::string> tags;
  uint64_t memory_bytes = 0;  // of its process; 0: not known
  std::vector<JobId> scenes;  // open jobs whose scenes it has in memory, at most kScenesShownMax
  std::string last_failure;   // what went wrong with the last unit or scene that it failed
};
constexpr size_t kScenesShownMax = 8;

}  // namespace tessera

template <>
struct std::hash<tessera::LeaseId> {
  // Sessions are random, and numbers count.
  size_t operator()(const tessera::LeaseId& id) const noexcept { return id.session ^ id.number; }
};
