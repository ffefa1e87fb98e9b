// Every number the scheduler decides by, with its reason.
#pragma once

#include <cstdint>

#include "coordinator/core/instant.h"

namespace tessera {

using std::chrono::milliseconds;
using std::chrono::seconds;

// ---- Sizes of units ----
// A unit costs about 0.2 ms beside its rendering (encode, send, check, merge): 15 ms keeps that near 1 %.
constexpr double kUnitDurationMin_s = 0.015;
// Longer units save nothing more, and delay previews, and lose more with a worker.
constexpr double kUnitDurationMax_s = 1.0;
// The first samples of each tile: short, so that the whole image is there soon.
constexpr double kFirstPassDuration_s = kUnitDurationMin_s;
// Guided sizing: a unit is this part of what is left for one slot. Each slot holds two units, so at 4 about
// half of the rest stays open, and the last units of all slots end together.
constexpr double kGuidedDivisor = 4;
// What the coordinator merges with ease. Farms with so many slots that shorter units would exceed it get
// longer ones.
constexpr double kResultsPerSecondMax = 1000;
// At the end of a frame the rate may be exceeded for a moment. Sizes are rounded down to powers of two, which
// makes half as many again: above what is merged in time, the units that end last wait longest.
constexpr double kResultsPerSecondBurst = 1500;
// Of a unit whose cost nobody has measured: long enough that only one waits behind the one that runs.
constexpr double kUnknownUnitDuration_s = 1.0;

// ---- What a worker holds ----
// Units per slot at least: one that runs and one that waits, so that no slot waits for a round trip.
constexpr int kUnitsPerSlotMin = 2;
// Short units wait in greater number, until they fill a slow network's round trip.
constexpr double kPrefetchDuration_s = 0.1;
constexpr int kUnitsPerSlotMax = 16;
// Of one job, being rendered or merged at the same time: each holds a picture in memory.
constexpr uint32_t kFramesActiveMax = 16;

// How much of a new measurement of the time that a scene takes to load counts: the first loads fetch files,
// too.
constexpr double kLoadGain = 0.3;
// Scenes that a worker fetches the files of while it renders others: the next jobs in the order of priority.
constexpr size_t kScenesAheadMax = 2;
constexpr Instant kPrefetchInterval = seconds(1);  // jobs are longer than that, or need no prefetch

// ---- Leases ----
// A worker that is heard of every 2 s and misses this long is hung or cut off; a loaded machine may miss
// some.
constexpr Instant kWorkerSilenceMax = seconds(10);
// A lease that was sent and never listed was lost on the way. Well above the time between two calls.
constexpr Instant kLeaseUnlistedMax = seconds(6);
// A lease that was listed and is no longer, though the worker lives.
constexpr Instant kLeaseDuration = seconds(10);
// A lease that a call does not list is sent again, unless the answer with it may still be on its way.
constexpr Instant kAnnounceAgain = milliseconds(250);
// Leases taken away on purpose that are remembered of each worker: more than states on their way can list.
constexpr size_t kRevokedKeptMax = 256;
// How long an idle call of a worker waits here: its break tells of the worker's end, so it is open nearly
// always.
constexpr Instant kParkMax = seconds(2);
// A worker that has gone stays in the list for people, and its measured speed for its return.
constexpr Instant kWorkerForgotten = seconds(60);
// One that is drained or quarantined must not shed that by a short absence.
constexpr Instant kBarForgotten = std::chrono::hours(24);
constexpr size_t kWorkersMax = 100'000;

// ---- The tail ----
// How often idle workers look for units to take from slower ones.
constexpr Instant kTailInterval = milliseconds(50);
// Moving a unit that has not started wastes nothing but a message.
constexpr double kStealGain = 1.2;
// A copy of a running unit wastes one of the two: it must promise to end clearly sooner.
constexpr double kBackupGain = 1.5;
// Message, scheduling noise: added to what a new holder is expected to take.
constexpr double kHandoverDuration_s = 0.02;
// Holders of the same samples, the first included.
constexpr int kCopiesMax = 2;
// Pieces that a straggler's range is cut into at most, when so many slots are idle.
constexpr int kSplitMax = 8;

// ---- Failure ----
// Different workers that fail a unit before its job fails: two may be ill, three are a poisonous unit. A farm
// that will never have three says so (SchedulerOptions).
constexpr int kAttemptsMaxDefault = 3;
// If all workers there are have failed a unit: how long another may take to join or come back.
constexpr Instant kPoisonGrace = seconds(60);
// Units a worker failed that others finished, or results refused, before it is quarantined.
constexpr int kStrikesMax = 3;
// Units in a row accepted from a worker after which its strikes are forgiven.
constexpr int kForgivenessUnits = 1000;
// Reports of failures kept per frame: far more than decide.
constexpr size_t kFailuresKeptMax = 1000;

// ---- Jobs ----
constexpr size_t kOpenJobsMax = 10'000;
// Ended jobs that are remembered, with their pictures.
constexpr size_t kEndedJobsMax = 10'000;

// ---- Speed ----
// How much of a new measurement of a worker's speed counts, once there are several.
constexpr double kSpeedGain = 0.2;
// Shorter units are noise to the clock: they count in proportion.
constexpr double kSpeedUnitDuration_s = 0.01;
constexpr double kSpeedMin = 0.01, kSpeedMax = 100;

}  // namespace tessera
