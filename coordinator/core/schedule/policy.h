// Every number that the scheduler decides by, with its reason.
#pragma once

#include <cstdint>

#include "coordinator/core/schedule/instant.h"

namespace tessera {

using std::chrono::milliseconds;
using std::chrono::seconds;

// ---- Sizes of units ----
// A unit costs about 0.2 ms besides its rendering (encode, send, check, merge): 15 ms keeps that near 1 %.
constexpr double kUnitDurationMin_s = 0.015;
// Longer units save nothing more, delay previews, and lose more when a worker dies.
constexpr double kUnitDurationMax_s = 1.0;
// The first samples of each tile: short, so that the whole image is visible soon.
constexpr double kFirstPassDuration_s = kUnitDurationMin_s;
// Guided sizing: a unit is this part of what is left for one slot. Each slot holds two units, so at 4 about
// half of the rest stays open, and the last units of all slots end together.
constexpr double kGuidedDivisor = 4;
// What the coordinator merges with ease. Farms whose many slots would exceed it with short units get longer
// ones.
constexpr double kResultsPerSecondMax = 1000;
// At the end of a frame the rate may be exceeded for a moment. Sizes are rounded down to powers of two, which
// makes half as many units again; beyond what is merged in time, the units that end last wait longest.
constexpr double kResultsPerSecondBurst = 1500;
// Assumed for a unit of a frame that was never measured: long enough that only one waits after the one that
// runs.
constexpr double kUnknownUnitDuration_s = 1.0;

// ---- What a worker holds ----
// At least one that runs and one that waits, so that no slot waits for a round trip.
constexpr int kUnitsPerSlotMin = 2;
// More short units wait, until they fill the round trip of a slow network.
constexpr double kPrefetchDuration_s = 0.1;
constexpr int kUnitsPerSlotMax = 16;
// Frames of one job that are rendered or merged at the same time: each holds a picture in memory.
constexpr uint32_t kFramesActiveMax = 16;
// The same over all jobs: frames, their tiles (some 200 bytes each and a microsecond to begin), and the bytes
// of their sums. 2 GiB are 64 frames of 1920 x 1080 pixels with four channels.
constexpr uint64_t kActiveFramesMax = 256;
constexpr uint64_t kActiveTilesMax = uint64_t{1} << 20;
constexpr uint64_t kActiveBytesMax = uint64_t{2} << 30;
// Up to this many times the limits, frames are begun for the most urgent job and for workers that find no
// work in those that are begun. One frame beyond that is begun for a worker that can do nothing else.
constexpr uint64_t kActiveStretch = 4;

// How much a new measurement of a scene's loading time counts: the first loads also fetch files.
constexpr double kLoadGain = 0.3;
// Scenes whose files a worker fetches while it renders others: those of the next jobs by priority.
constexpr size_t kScenesAheadMax = 2;
constexpr Instant kPrefetchInterval = seconds(1);  // jobs take longer or need no prefetch

// ---- Leases ----
// Workers call every 2 s. One that has been silent for this long hangs or is cut off; a loaded machine may
// miss some calls.
constexpr Instant kWorkerSilenceMax = seconds(10);
// A state with a lower sequence than the last one was overtaken on its way. After this long it was not: the
// higher one was not the worker's. Shorter than kWorkerSilenceMax, so that the worker is not lost meanwhile.
constexpr Instant kStateReorderMax = seconds(5);
// A lease that was sent and never listed was lost on the way. Well above the interval of calls.
constexpr Instant kLeaseUnlistedMax = seconds(6);
// A lease that was listed and no longer is, though the worker lives.
constexpr Instant kLeaseDuration = seconds(10);
// A lease that a call does not list is sent again after this: earlier the answer with it may still be on its
// way.
constexpr Instant kAnnounceAgain = milliseconds(250);
// Of the leases in one answer, encoded, and of the ids to drop: far below the message limit. What is left
// follows in the next answer.
constexpr size_t kGrantBytesMax = 256 << 10;
constexpr size_t kLeaseBytes = 160;  // encoded, without its pixel mask
constexpr size_t kDropsPerAnswerMax = 16'384;
// Leases taken away on purpose that are remembered for each worker: more than states on their way can list.
constexpr size_t kRevokedKeptMax = 256;
// How long an idle call of a worker waits here. When it breaks the worker has died, so a call is open nearly
// always.
constexpr Instant kParkMax = seconds(2);
// How long a worker that has gone is remembered, with its measured speed, in case it returns.
constexpr Instant kWorkerForgotten = seconds(60);
// The same of a worker of a member that has failed something: others may finish it that late, and the next
// process of the same machine has to answer for it.
constexpr Instant kFailedWorkerForgotten = std::chrono::hours(1);
// A drain or a quarantine must not end by a short absence.
constexpr Instant kBlockForgotten = std::chrono::hours(24);
constexpr size_t kWorkersMax = 100'000;

// ---- Preparations (preparations.h) ----
// Those that a worker does not list lapse as leases do. One that a worker lists for this long has failed: by
// default workers give up a scene that takes an hour to load (--load-timeout), and they may load another
// scene first.
constexpr Instant kPreparationDurationMax = std::chrono::hours(2);

// ---- The tail ----
// How often idle workers look for units to take from slower ones.
constexpr Instant kTailInterval = milliseconds(50);
// Moving a unit that has not started costs a message only.
constexpr double kStealGain = 1.2;
// A copy of a running unit wastes one of the two: it must promise to end clearly sooner.
constexpr double kBackupGain = 1.5;
// Message and scheduling noise: added to what a new holder is expected to take.
constexpr double kHandoverDuration_s = 0.02;
// Holders of the same samples, including the first.
constexpr int kCopiesMax = 2;
// At most this many pieces are made of a straggler's range, if as many slots are idle.
constexpr int kSplitMax = 8;

// ---- Verification ----
// How long a unit waits for a vote from another machine than those that have rendered it. As long as silent
// workers are waited for: a machine that has not answered by then may never do so.
constexpr Instant kOtherMachinePatience = seconds(10);

// ---- Failure ----
// Different workers that fail a unit before its frame fails: two workers may be broken, after three it is the
// unit. A farm that never has three workers sets a smaller number (SchedulerOptions).
constexpr int kAttemptsMaxDefault = 3;
// Failed frames of a job after which its other frames are given up, unless they are at most this share of the
// finished ones. Fewer may be special; after that, the others probably fail for the same cause.
constexpr size_t kFailedFramesMax = 3;
constexpr double kFailedFramesShare = 0.1;
// How long to wait for another worker if all connected ones have failed a unit.
constexpr Instant kPoisonGrace = seconds(60);
// Units that a worker failed and others finished, or results refused, before it is quarantined.
constexpr int kStrikesMax = 3;
// Accepted units in a row after which a worker's strikes are forgiven.
constexpr int kForgivenessUnits = 1000;
// ---- Workers that vanish (loss_book.h) ----
// Different workers that are lost with a scene or unit in hand before it has killed them: as with failures.
constexpr size_t kLossesMax = 3;
// Losses within this time have one cause outside: power, network, a scheduler that ends its jobs. Well above
// the interval of calls, after which silence is noticed.
constexpr Instant kCrowdWindow = seconds(5);
// On large farms some workers always vanish: a crowd is this part of the farm, and at least one other worker.
constexpr size_t kCrowdDivisor = 50;
// A worker that fell silent may only be cut off or hang, and is waited for before its loss counts.
constexpr Instant kSilentLossSettles = seconds(25);
// After a loss a suspect rests until all other losses of the same moment are noticed and judged. Who tries it
// must have been in contact after them.
constexpr Instant kTrialRest = seconds(6), kTrialContactAfter = seconds(3);
// Kept of each suspect and in all: far more than are needed to decide.
constexpr size_t kLossesKeptMax = 100, kVanishedKeptMax = 10'000;

// Failures kept per frame: far more than are needed to decide.
constexpr size_t kFailuresKeptMax = 1000;
// The same of a scene, for each cause: all workers of a large farm may be too small for it.
constexpr size_t kSceneFailuresKeptMax = kWorkersMax;

// ---- Pictures ----
// A full disk empties slowly.
constexpr Instant kPictureRetry = seconds(2);
// Kept sums that are removed together when the disk is full; a few may free enough space.
constexpr size_t kSumsGivenUpMax = 4;

// ---- Jobs ----
constexpr size_t kOpenJobsMax = 10'000;
// Specifications of open jobs in memory: 10,000 jobs of some 25 frames each. Ended jobs are forgotten, oldest
// first, while all jobs take more.
constexpr uint64_t kSpecBytesMax = uint64_t{128} << 20;
// Ended jobs that are kept, with their pictures.
constexpr size_t kEndedJobsMax = 10'000;

// ---- Speed ----
// How much a new measurement of a worker's speed counts once there are several.
constexpr double kSpeedGain = 0.2;
// Shorter units cannot be measured well: they count in proportion.
constexpr double kSpeedUnitDuration_s = 0.01;
constexpr double kSpeedMin = 0.01, kSpeedMax = 100;

}  // namespace tessera
