// What goes into a farm and what comes out of it, as values.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/core/fact.h"
#include "coordinator/core/schedule/job_message.h"
#include "coordinator/core/schedule/worker_sync.h"
#include "coordinator/core/spool.h"
#include "proto/terms.h"
#include "renderer/film/frame_snapshot.h"
#include "renderer/film/merger.h"
#include "renderer/film/radiance_tile.h"
#include "renderer/util/result.h"

namespace tessera {

// Names a call that waits for its answer; drawn by the caller.
enum class CallId : uint64_t {};

struct ReturnedUnit {
  LeaseId lease{};
  WorkUnit unit;
  double render_seconds = 0;
  Result<RadianceTile> tile{Failed("no tile")};  // or what is wrong with its bytes
  FarmId farm{};                                 // whose lease it is
};

struct FinishedPicture {
  JobId job{};
  uint32_t frame = 0;
  std::shared_ptr<const JobSpec> spec;
  FrameSnapshot snapshot;   // to be painted off the deciding thread
  bool is_complete = true;  // otherwise its job has ended before
};

// What to do after a batch of events, in this order: put `accepted` into the spool and the facts into the
// journal, sync both, the spool first; then the rest.
struct FarmOutput {
  struct Accepted {
    FrameId frame;
    TileNode node;
  };
  struct Sums {
    FrameId frame;
    std::vector<TileNode> nodes;
  };
  struct Directive {
    CallId call{};
    WorkerDirective directive;
  };
  struct Results {
    CallId call{};
    std::vector<Verdict> verdicts;
    std::vector<std::string> reasons;  // of the refused
    LeaseGrants grants;
    FarmId farm{};
  };
  std::vector<Accepted> accepted;
  std::vector<Fact> facts;
  std::vector<Sums> sums;  // of frames that are complete: replace in the spool what was accepted of them
  std::vector<FrameId> dropped;  // from the spool
  std::vector<FrameId> loads;    // from the spool; then call SumsLoaded
  std::vector<JobId> forgotten;  // their pictures may be removed
  std::vector<Directive> directives;
  std::vector<Results> results;
  std::vector<FinishedPicture> pictures;  // to be written to files; then call PictureWritten
  // Of jobs that ended before these frames were complete. Written in the same way.
  std::vector<FinishedPicture> partial_pictures;
  std::vector<std::string> log;  // "event key=value ..."
  std::vector<JobMessage> messages;
};

}  // namespace tessera
