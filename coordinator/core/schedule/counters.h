// What a coordinator has counted since it started. Plain numbers that only grow: a rate or the share of one
// job is the difference between two moments. Owned by the scheduler; the shell adds what only it can measure.
#pragma once

#include <cstdint>

namespace tessera {

struct FarmCounters {
  // Results, by what became of them.
  uint64_t units_accepted = 0, units_duplicate = 0, units_obsolete = 0, units_refused = 0;
  uint64_t units_failed = 0;      // reported by workers as failed
  uint64_t samples_accepted = 0;  // pixel samples merged
  uint64_t samples_wasted = 0;    // pixel samples of results that brought nothing new

  // Leases.
  uint64_t leases_granted = 0;
  uint64_t leases_expired = 0;
  uint64_t leases_retried = 0;  // ended without a result: their samples were open again
  uint64_t leases_moot = 0;     // taken from their holders because others were faster
  uint64_t workers_lost = 0;

  // Time of render slots, in seconds: `slot_s` is the sum of the four below it.
  double slot_s = 0;
  double leased_s = 0;    // with a unit in hand
  double fetching_s = 0;  // idle while their worker fetches the files of a scene
  double loading_s = 0;   // idle while their worker reads and builds a scene
  double idle_s = 0;      // idle for lack of work

  double render_s = 0;  // of slots, on results accepted, as workers measured it
  double waste_s = 0;   // of slots, on results that brought nothing new and on units that were given up

  // Of the coordinator itself, in seconds; measured by the shell.
  double core_s = 0;     // deciding and merging
  double journal_s = 0;  // waiting for the disk to take the journal
  double picture_s = 0;  // encoding and writing pictures
  uint64_t journal_syncs = 0;
};

}  // namespace tessera
