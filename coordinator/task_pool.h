// Threads for work that takes long, such as encoding and files, so that the threads of gRPC and of the core
// never wait for it. Tasks of several threads run in any order, those of one thread in the order of Post.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tessera {

class TaskPool {
 public:
  explicit TaskPool(int threads);
  ~TaskPool();  // Stop
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  // Thread safe.
  void Post(std::function<void()> task);
  // Runs the tasks posted so far, then ends the threads.
  void Stop();

 private:
  void Run();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;  // guarded by mutex_
  bool stopping_ = false;                    // guarded by mutex_
  std::vector<std::thread> threads_;
};

// Long tasks have threads of their own, so that short ones never wait for them.
struct FileThreads {
  // One piece of a file, and looks at many files.
  TaskPool brief{4};
  // Whole files: hashing and syncing.
  TaskPool lengthy{2};
  void Stop() {
    brief.Stop();
    lengthy.Stop();
  }
};

}  // namespace tessera
