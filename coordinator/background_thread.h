// A thread for what takes long: encoding, files. Tasks run one after the other.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace tessera {

class BackgroundThread {
 public:
  BackgroundThread();
  ~BackgroundThread();  // Stop
  // Thread safe.
  void Post(std::function<void()> task);
  // Runs what was posted, then ends the thread.
  void Stop();
  // For a task: waits, at most until Stop; whether it may go on.
  bool Sleep(std::chrono::milliseconds duration);

 private:
  void Run();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  // guarded by mutex_
  bool stopping_ = false;                    // guarded by mutex_
  std::thread thread_;
};

}  // namespace tessera
