// A thread for tasks that take long, such as encoding and files. They run one after the other.
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
  // Runs the tasks posted so far, then ends the thread.
  void Stop();
  // For a task: waits for `duration` or until Stop. Returns false once Stop was called.
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
