// Shows a picture while it is rendered, on threads of its own. A view that waits or fails does not delay the
// render.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "client/live/picture_view.h"
#include "renderer/util/threads.h"

namespace tessera {

// How long a view waits after a picture that took `cost` to get and to show: at least a second, and long
// enough that pictures take at most a twentieth of the time.
std::chrono::milliseconds PauseAfter(std::chrono::milliseconds cost);

// Owned by the command that renders or watches. Its functions are called on one thread.
class LiveViews {
 public:
  // A request to stop ends all views.
  explicit LiveViews(const std::stop_token& stop);
  // Ends the views as they are.
  ~LiveViews();
  LiveViews(const LiveViews&) = delete;
  LiveViews& operator=(const LiveViews&) = delete;
  // Starts a thread that shows the pictures of the source. Its errors are printed as warnings, once for each
  // reason. Fails if the system starts no more threads.
  Result<void> Add(std::unique_ptr<PictureSource> source, std::unique_ptr<PictureView> view);
  // Shows the last picture, which the sources must have by now, and ends. Views that take longer than
  // `patience` are stopped.
  void Finish(std::chrono::milliseconds patience = std::chrono::seconds(5));

 private:
  void Run(PictureSource& source, PictureView& view);
  // Shows the next picture if there is one. Returns whether there was.
  bool ShowNext(PictureSource& source, PictureView& view, std::set<std::string>& warnings);
  // Waits, and calls Idle of the view meanwhile. Returns false if this was the end.
  bool Wait(std::chrono::milliseconds duration, PictureView& view);

  std::stop_source stop_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_finishing_ = false;  // guarded by mutex_
  int running_ = 0;            // guarded by mutex_
  std::vector<std::unique_ptr<PictureSource>> sources_;
  std::vector<std::unique_ptr<PictureView>> views_;
  ThreadGroup threads_;
  std::stop_callback<std::function<void()>> on_stop_;
};

}  // namespace tessera
