// The spool as files: a folder JOB-FRAME for each frame, in it record logs (record_log.h) "TSRS", version 1,
// whose payloads are a node: tile, begin and size of its samples, 32 bits each, then its sums as floats,
// little-endian.
//   segment-N  what was accepted while N was the newest
//   base-N     every node that a merger made of what was accepted before segment N began
// What counts is the newest base and the segments from its number on. Results are a set, so a base needs no
// moment of rest: it is written in the background from a copy while results go to the next segment, renamed
// to its name when it is whole, and then the older files go.
//
// Disk use: a segment is replaced when it has grown to max(kSegmentBytesMin, size of the base), and results
// wait while a second one has grown to that and the base is still being written. So, with L the size of the
// nodes that the merger of the frame holds at most, the files of a frame take no more than
//   4 x max(kSegmentBytesMin, L) + two batches
// (old base, its segment, new base, its segment), however many results were merged; half of that when idle. A
// frame whose kept sums are on their way back from the spool has no base yet: its results of that moment come
// on top.
//
// A torn tail of the newest segment was never acknowledged: it is cut off. Damage anywhere else is refused by
// name; whoever moves the named file away loses what is in it, and no more than that is rendered again.
// One thread calls it, the core thread; files that take long are written by `run`.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/spool.h"
#include "coordinator/store/frame_files.h"
#include "coordinator/store/record_log.h"
#include "renderer/util/result.h"

namespace tessera {

// Below it a base costs more than the segment that it replaces.
constexpr uint64_t kSegmentBytesMin = uint64_t{8} << 20;

class FileSpool : public Spool {
 public:
  // Runs a task on some other thread, or at once; tasks in their order.
  using Run = std::function<void(std::function<void()> task)>;
  static Result<std::unique_ptr<FileSpool>> Open(const std::string& path, Run run,
                                                 uint64_t segment_bytes_min = kSegmentBytesMin);

  // ---- After a start ----
  struct Found {
    FrameId frame;
    uint64_t bytes = 0;
    bool begun = false;  // there are results that no base holds
  };
  std::vector<Found> Frames() const;
  // Gives the nodes of a frame that is to be gone on with.
  Result<void> Restore(FrameId frame, const std::function<void(TileNode)>& restore);

  void Append(FrameId frame, TileNode node) override;
  Result<void> Sync() override;
  std::vector<FrameId> Grown() const override;
  void Replace(FrameId frame, std::vector<TileNode> nodes) override;
  void Drop(FrameId frame) override;
  void Load(FrameId frame, OnLoaded done) override;

 private:
  struct Frame {
    std::shared_ptr<FrameFiles> files;   // shared with what runs in the background
    std::unique_ptr<RecordLog> segment;  // the newest; null: begun when it is needed
    std::vector<TileNode> pending;       // not yet in the log
  };
  FileSpool(std::string path, Run run, uint64_t segment_bytes_min)
      : path_(std::move(path)), run_(std::move(run)), segment_bytes_min_(segment_bytes_min) {}
  void Scan();
  Frame& Need(FrameId id);
  std::string FolderOf(FrameId id) const;
  Result<void> SyncFrame(FrameId id, Frame& frame);
  bool IsGrown(const FrameFiles& files) const;

  std::string path_;
  Run run_;
  uint64_t segment_bytes_min_;
  std::map<FrameId, Frame> frames_;
  std::set<FrameId> open_;  // have an open segment
  std::set<FrameId> unsynced_;
  uint64_t drops_ = 0;
};

}  // namespace tessera
