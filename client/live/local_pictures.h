// The picture of a frame that this process renders.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/live/picture_view.h"
#include "renderer/film/frame_snapshot.h"

namespace tessera {

// Hands pictures from the thread that renders to that of a view. A snapshot is taken only when the view asks
// for one, and painted on the view's thread. Thread safe.
class PictureHandoff {
 public:
  using TakeSnapshot = std::function<FrameSnapshot()>;
  // Called by the renderer, often. Takes a snapshot if one is wanted.
  void Offer(int frame, const TakeSnapshot& take);
  // The frame is finished: the bytes of its OpenEXR file.
  void Finish(int frame, std::string exr);

  struct Work {
    int frame = 0;
    std::optional<FrameSnapshot> snapshot;
    std::string exr;  // unless there is a snapshot
  };
  // Called by the view. Waits a moment for the renderer; returns nullopt if there is nothing new.
  std::optional<Work> Take(const std::stop_token& stop);

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool is_wanted_ = false;
  std::optional<Work> work_;
};

class LocalPictures : public PictureSource {
 public:
  explicit LocalPictures(std::shared_ptr<PictureHandoff> handoff) : handoff_(std::move(handoff)) {}
  Result<std::optional<LivePicture>> Next(const std::stop_token& stop) override;

 private:
  const std::shared_ptr<PictureHandoff> handoff_;
};

}  // namespace tessera
