// The files of one frame in the spool (file_spool.h). Shared by the core thread, which appends to the newest
// segment, and the background, which writes bases. Thread safe.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/store/node_log.h"
#include "renderer/film/merger.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

namespace tessera {

class FrameFiles {
 public:
  struct File {
    uint64_t number = 0;
    uint64_t bytes = 0;
    std::optional<Digest> scene = {};  // that is part of its name
  };

  explicit FrameFiles(std::string folder) : folder_(std::move(folder)) {}

  // Finds the files that an earlier process left, and removes those that were replaced or never finished.
  // Call it before anything else, once.
  Result<void> Scan();

  // Sets what the frame is rendered from. Call it before files are read or written.
  void SetGuard(SceneGuard guard);
  // Makes the scene part of the names of the files that have none. Called once, before an older directory is
  // used: what its files hold that names no scene is of this one.
  Result<void> BindTo(const Digest& scene);
  // Creates the next segment, and the folder if there is none.
  Result<std::unique_ptr<NodeLog>> BeginSegment();
  // Visits the nodes of the newest segment and opens it for appending. Null if there is none, or if it is
  // not appended to (NodeLog::Open).
  Result<std::unique_ptr<NodeLog>> ReopenSegment(const std::function<void(TileNode)>& visit,
                                                 const RecordLog::OnTorn& on_torn = {});
  // Sets the size of the newest segment.
  void SetSegmentBytes(uint64_t bytes);
  // Size of the newest segment; 0 if it is part of a base that exists or is being written.
  uint64_t segment_bytes() const;
  uint64_t base_bytes() const;
  uint64_t bytes() const;  // of all files
  bool has_segments() const;

  // Announces a base that will contain all present segments. Call WriteBase with the number next.
  uint64_t BeginBase();
  // Writes it, then removes what it replaces. Slow.
  void WriteBase(uint64_t number, std::vector<TileNode> nodes);
  bool is_writing_base() const;
  // Waits until no base is being written. Returns the error of the last one, once.
  Result<void> AwaitBase();

  // Visits the nodes of the base and of the segments, except for the newest segment if `but_newest`. The
  // newest segment may be growing. Slow.
  Result<void> Read(bool but_newest, const std::function<void(TileNode)>& visit) const;

 private:
  Result<uint64_t> WriteBaseFile(uint64_t number, std::vector<TileNode> nodes) const;
  std::string SegmentPath(const File& segment) const;
  std::string BasePath(const File& base) const;
  SceneGuard GuardOf(const File& file) const;  // with the mutex held

  const std::string folder_;
  mutable std::mutex mutex_;
  std::condition_variable base_ended_;
  // All guarded by mutex_.
  SceneGuard guard_;
  std::vector<File> segments_;  // from base_.number on, in order
  File base_;                   // number 0: none
  uint64_t base_next_ = 0;      // the base that is being written
  bool is_writing_ = false;
  Result<void> outcome_;  // of the last base, until it is told
};

}  // namespace tessera
