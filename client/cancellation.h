// The request to stop a command, with its reason. Shared by everything that the command waits for.
#pragma once

#include <mutex>
#include <optional>
#include <stop_token>

#include "renderer/util/result.h"

namespace tessera {

// Thread safe.
class Cancellation {
 public:
  // Requests a stop from everything that holds the token. The first reason is kept.
  void Cancel(Error reason) {
    {
      const std::lock_guard lock(mutex_);
      if (!reason_) reason_ = std::move(reason);
    }
    source_.request_stop();
  }
  std::stop_token token() const { return source_.get_token(); }
  bool cancelled() const { return source_.stop_requested(); }
  // Call only if cancelled.
  Error error() const {
    const std::lock_guard lock(mutex_);
    return reason_.value();
  }

 private:
  std::stop_source source_;
  mutable std::mutex mutex_;
  std::optional<Error> reason_;
};

}  // namespace tessera
