#include "renderer/util/threads.h"

#include <fmt/format.h>

#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>

namespace tessera {

Error CannotStartThread(const std::system_error& why) {
  return Failed(
      fmt::format("cannot start a thread: {}; use fewer threads, or raise the limit on processes or memory "
                  "(ulimit -u, -v)",
                  why.code().message()));
}

Result<void> CheckThreads(int count) {
  std::mutex mutex;
  std::condition_variable released;
  bool is_over = false;
  const auto wait = [&] {
    std::unique_lock lock(mutex);
    released.wait(lock, [&] { return is_over; });
  };
  ThreadGroup group([](const Error&) {});
  Result<void> started;
  for (int i = 0; started && i < count; ++i) started = group.Start(wait);
  const std::lock_guard lock(mutex);
  is_over = true;
  released.notify_all();
  return started;
}

Result<void> ThreadGroup::Start(std::function<void()> body) {
  try {
    threads_.reserve(threads_.size() + 1);
    threads_.emplace_back([this, body = std::move(body)] {
      try {
        body();
      } catch (const std::exception& e) {
        on_error_(Failed(fmt::format("a thread ended with an error: {}", e.what())));
      }
    });
  } catch (const std::system_error& e) {
    return CannotStartThread(e);
  }
  return {};
}

void ThreadGroup::Join() {
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace tessera
