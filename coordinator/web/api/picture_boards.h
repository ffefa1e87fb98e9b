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
#include <string>
#include <thread>
#include <utility>

#include "coordinator/core/spool.h"
#include "coordinator/web/api/picture_board.h"
#include "coordinator/web/api/web_farm.h"

namespace tessera {

constexpr int kSmallSize = 160;   // pixels, for lists
constexpr int kMediumSize = 640;  // for sequences that are played

// Thread safe.
class PictureBoards {
 public:
  using Clock = std::chrono::steady_clock;
  // The functions must stay usable until Stop.
  explicit PictureBoards(const WebFarm& farm);
  ~PictureBoards();
  void Stop();

  // The messages of picture_format.h for a layer (picture_layers.h). An error if too many pictures are being
  // watched.
  WebResult<std::shared_ptr<BodyStream>> Watch(FrameId frame, const std::string& layer = "");
  // A PNG file at most `size` pixels wide and high: kSmallSize or kMediumSize. Returns null if it is not made
  // yet: it is made soon.
  std::shared_ptr<const std::string> Thumbnail(FrameId frame, int size = kSmallSize);

  // Takes bytes from the budget of all streams. Returns how many may be sent now, 0 if none.
  size_t TakeBudget(size_t wanted);
  void GiveBudgetBack(size_t unused);

 private:
  using BoardId = std::pair<FrameId, std::string>;  // and its layer
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
  // `count`: boards that are being watched, which share the time.
  void Refresh(FrameId frame, size_t count, Watched& watched);
  // Shows what has changed. An error if the picture cannot be shown now.
  Result<void> Update(FrameId frame, const FrameState& state, Watched& watched) const;
  using SmallId = std::pair<FrameId, int>;  // and its size
  void MakeSmall(std::unique_lock<std::mutex>& lock);
  Result<LoadedPicture> Load(FrameId frame, const FrameState& state) const;
  std::shared_ptr<const std::string> SmallPng(SmallId id, SmallPicture& small) const;
  void ForgetSmall();

  const WebFarm& farm_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_; the thread alone removes boards.
  bool stopping_ = false;
  std::map<BoardId, Watched> boards_;
  std::map<SmallId, SmallPicture> small_;
  std::deque<SmallId> small_wanted_;
  Clock::time_point small_due_{};
  double budget_ = 0;
  Clock::time_point budget_at_{};

  std::thread thread_;
};

}  // namespace tessera
