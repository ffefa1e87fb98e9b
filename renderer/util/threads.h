// Threads that may fail to start and whose exceptions do not end the process.
#pragma once

#include <functional>
#include <system_error>
#include <thread>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Whether `count` more threads can be started now. Libraries end the process if theirs cannot, so programs
// ask before they use them. The error says what to do.
Result<void> CheckThreads(int count);

// The error of a thread that the system did not start (std::thread), with what to do.
Error CannotStartThread(const std::system_error& why);

// Threads that are joined together. Not thread safe.
class ThreadGroup {
 public:
  // `on_error` is called on the thread whose body ended with an exception, such as std::bad_alloc.
  explicit ThreadGroup(std::function<void(Error)> on_error) : on_error_(std::move(on_error)) {}
  ~ThreadGroup() { Join(); }
  ThreadGroup(const ThreadGroup&) = delete;
  ThreadGroup& operator=(const ThreadGroup&) = delete;
  // Runs `body` on a new thread. An error if the system starts no more threads.
  Result<void> Start(std::function<void()> body);
  // Waits for all threads.
  void Join();
  size_t size() const { return threads_.size(); }

 private:
  const std::function<void(Error)> on_error_;
  std::vector<std::thread> threads_;
};

}  // namespace tessera
