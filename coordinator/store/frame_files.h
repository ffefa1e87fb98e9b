// The files of one frame in the spool (file_spool.h). Shared by the core thread, which appends to the newest
// segment, and the background, which writes bases. Thread safe.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "coordinator/store/record_log.h"
#include "renderer/film/merger.h"
#include "renderer/util/result.h"

namespace tessera {

// Puts a node into a log of the spool.
void AppendNode(RecordLog& log, TileNode node);

class FrameFiles {
 public:
  struct File {
    uint64_t number = 0;
    uint64_t bytes = 0;
  };

  // Looks at the folder, which need not exist, and removes files that were replaced or never finished.
  explicit FrameFiles(std::string folder);

  // Makes the next segment and its folder.
  Result<std::unique_ptr<RecordLog>> BeginSegment();
  // Opens the newest segment to go on with it; its nodes are handed out first. Null if there is none.
  Result<std::unique_ptr<RecordLog>> ReopenSegment(const std::function<void(TileNode)>& visit);
  // Tells the size of the newest segment.
  void SetSegmentBytes(uint64_t bytes);
  // Of the newest segment, if it is not part of a base that is there or being written.
  uint64_t segment_bytes() const;
  uint64_t base_bytes() const;
  uint64_t bytes() const;  // of all files
  bool has_segments() const;

  // The segments that there are will be part of a base. Call WriteBase with the number next.
  uint64_t BeginBase();
  // Writes it, then removes what it replaces. Takes long.
  void WriteBase(uint64_t number, std::vector<TileNode> nodes);
  bool is_writing_base() const;
  // Waits until no base is being written; what was wrong with the last, if it could not be written and this
  // was not told before.
  Result<void> AwaitBase();

  // Hands out the nodes of the base and of the segments, but not of the newest if `open_segment`. Takes long.
  Result<void> Read(bool open_segment, const std::function<void(TileNode)>& visit) const;

 private:
  Result<uint64_t> WriteBaseFile(uint64_t number, std::vector<TileNode> nodes) const;
  std::string SegmentPath(uint64_t number) const;
  std::string BasePath(uint64_t number) const;

  const std::string folder_;
  mutable std::mutex mutex_;
  std::condition_variable base_ended_;
  // All guarded by mutex_.
  std::vector<File> segments_;  // from base_.number on, in order
  File base_;                   // number 0: none
  uint64_t base_next_ = 0;      // the base that is being written
  bool is_writing_ = false;
  Result<void> outcome_;  // of the last base, until it is told
};

}  // namespace tessera
