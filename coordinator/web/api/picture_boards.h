// All pictures that are being watched, and small ones for lists of jobs. A thread of its own asks for the
// frames, paints what has changed and encodes it, once for all who watch a frame. It works a bounded share of
// its time, and all streams together send a bounded number of bytes per second, so the farm renders as fast
// with many watchers as without.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "coordinator/core/spool.h"
#include "coordinator/web/api/picture_board.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

// Thread safe.
class PictureBoards {
 public:
  using Clock = std::chrono::steady_clock;
  // The functions must stay usable until Stop.
  explicit PictureBoards(const WebFarm& farm);
  ~PictureBoards();
  void Stop();

  // The messages of picture_format.h. An error if too many pictures are being watched.
  WebResult<std::shared_ptr<BodyStream>> Watch(FrameId frame);
  // A PNG file at most kThumbnailSize pixels wide and high. Returns null if it is not made yet: it is made
  // soon.
  std::shared_ptr<const std::string> Thumbnail(FrameId frame);

  // Takes bytes from the budget of all streams. Returns how many may be sent now, 0 if none.
  size_t TakeBudget(size_t wanted);
  void GiveBudgetBack(size_t unused);

 private:
  struct Watched {
    std::shared_ptr<PictureBoard> board;
    Clock::time_point due{}, used{};
    std::optional<Digest> file;  // that the board shows
    bool has_partial = false;
  };
  struct SmallPicture {
    std::shared_ptr<const std::string> png;
    Clock::time_point due{};  // when it is made again
    uint64_t samples_done = UINT64_MAX;
    Clock::time_point used{};
  };
  void Run();
  void RefreshDue(std::unique_lock<std::mutex>& lock);
  void Refresh(FrameId frame, Watched& watched);
  void MakeSmall(std::unique_lock<std::mutex>& lock);
  WebResult<LoadedPicture> Load(FrameId frame, const FrameState& state) const;
  std::shared_ptr<const std::string> SmallPng(FrameId frame, SmallPicture& small) const;
  void ForgetSmall();

  const WebFarm& farm_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_; the thread alone removes boards.
  bool stopping_ = false;
  std::map<FrameId, Watched> boards_;
  std::map<FrameId, SmallPicture> small_;
  std::deque<FrameId> small_wanted_;
  Clock::time_point small_due_{};
  double budget_ = 0;
  Clock::time_point budget_at_{};

  std::thread thread_;
};

}  // namespace tessera
