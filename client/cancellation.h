// Why and when to stop: one per command, shared by all that it waits for.
#pragma once

#include <mutex>
#include <optional>
#include <stop_token>

#include "renderer/util/result.h"

namespace tessera {

// Thread safe.
class Cancellation {
 public:
  // Asks everything that holds the token to stop. The first reason is kept.
  void Cancel(Error why) {
    {
      const std::lock_guard lock(mutex_);
      if (!why_) why_ = std::move(why);
    }
    source_.request_stop();
  }
  std::stop_token token() const { return source_.get_token(); }
  bool cancelled() const { return source_.stop_requested(); }
  // Call only if cancelled.
  Error error() const {
    const std::lock_guard lock(mutex_);
    return why_.value();
  }

 private:
  std::stop_source source_;
  mutable std::mutex mutex_;
  std::optional<Error> why_;
};

}  // namespace tessera
