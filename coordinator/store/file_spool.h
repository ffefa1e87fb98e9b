// The spool as files: a folder JOB-FRAME for each frame, in it logs of nodes (node_log.h), of version 2 or 1.
//   segment-N  what was accepted while N was the newest
//   base-N     every node that a merger made of what was accepted before segment N began
// Files of older directories, which name no scene, were called segment-N-of-SCENE and base-N-of-SCENE when
// the directory was opened first.
// What counts is the newest base and the segments from its number on. Results are a set, so a base can be
// written at any time: in the background, from a copy, while results go to the next segment. It is renamed to
// its final name when it is whole, and then the older files are removed.
//
// Disk use: a segment is replaced when it has grown to max(kSegmentBytesMin, size of the base), and results
// wait while a second one has grown to that size and the base is still being written. If L is the largest
// size of the nodes in the merger of the frame, the files of a frame take at most
//   4 x max(kSegmentBytesMin, L) + two batches
// (old base, its segment, new base, its segment), regardless of the number of results; half of that when
// idle. A frame whose kept sums are being loaded has no base yet, so the results of that moment come on top.
//
// A torn tail of the newest segment was never acknowledged and is cut off. Damage anywhere else is refused
// with the name of the file; after moving the file away only what was in it is rendered again.
// Only the core thread calls it; bases are written by `run`.
#pragma once

#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/spool.h"
#include "coordinator/store/frame_files.h"
#include "coordinator/store/node_log.h"
#include "renderer/util/result.h"

namespace tessera {

// A smaller segment costs less than the base that would replace it.
constexpr uint64_t kSegmentBytesMin = uint64_t{8} << 20;
// Segments whose files are open, those that were written last: more than the frames that farms render at the
// same time, and few for a process.
constexpr size_t kOpenFilesMax = 32;

class FileSpool : public Spool {
 public:
  // Runs tasks in order, on another thread or immediately.
  using Run = std::function<void(std::function<void()> task)>;
  static Result<std::unique_ptr<FileSpool>> Open(const std::string& path, Run run,
                                                 uint64_t segment_bytes_min = kSegmentBytesMin);

  // From now on, files name the scene that their frame is rendered from, and results of another scene are
  // ignored. `scene_of` is called by the methods below and returns nullopt if the frame is not known.
  // `on_foreign` is called on any thread, with the path of each file that holds such results when it is read.
  using SceneOf = std::function<std::optional<Digest>(FrameId)>;
  void NameScenes(SceneOf scene_of, std::function<void(const std::string& path)> on_foreign);

  // Binds the files of all frames whose scene is known to it. Call it when a directory of an older version is
  // opened, after NameScenes.
  Result<void> BindToScenes();

  // ---- After a start ----
  struct Found {
    FrameId frame;
    uint64_t bytes = 0;
    bool begun = false;  // there are results that are in no base
  };
  std::vector<Found> Frames() const;
  // Calls `restore` with the nodes of a frame that will be continued.
  Result<void> Restore(FrameId frame, const std::function<void(TileNode)>& restore,
                       const RecordLog::OnTorn& on_torn = {});

  void Append(FrameId frame, TileNode node) override;
  Result<void> Sync() override;
  std::vector<FrameId> Grown() const override;
  void Replace(FrameId frame, std::vector<TileNode> nodes) override;
  void Drop(FrameId frame) override;
  void Load(FrameId frame, OnLoaded done) override;

 private:
  struct Frame {
    std::shared_ptr<FrameFiles> files;  // shared with what runs in the background
    std::unique_ptr<NodeLog> segment;   // the newest; null: begun when it is needed
    std::vector<TileNode> pending;      // not yet in the log
    bool is_guarded = false;            // the files know their scene
  };
  FileSpool(std::string path, Run run, uint64_t segment_bytes_min)
      : path_(std::move(path)), run_(std::move(run)), segment_bytes_min_(segment_bytes_min) {}
  Result<void> Scan();
  Frame& Need(FrameId id);
  std::string FolderOf(FrameId id) const;
  Result<void> SyncFrame(FrameId id, Frame& frame);
  void NoteOpenFile(FrameId id);
  bool IsGrown(const FrameFiles& files) const;

  std::string path_;
  Run run_;
  SceneOf scene_of_;
  std::function<void(const std::string& path)> on_foreign_;
  uint64_t segment_bytes_min_;
  std::map<FrameId, Frame> frames_;
  std::set<FrameId> open_;         // have an open segment
  std::list<FrameId> open_files_;  // of these, whose files are open; the last one written first
  std::set<FrameId> unsynced_;
  uint64_t drops_ = 0;
};

}  // namespace tessera
