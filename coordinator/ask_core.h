// A question to the core thread from a thread that may wait for the answer.
#pragma once

#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "coordinator/core_thread.h"

namespace tessera {

// Far longer than any batch takes; only a disk that hangs takes longer.
constexpr std::chrono::milliseconds kCorePatience{2000};

// Runs `question` on the core thread and returns its answer; nullopt if that takes longer than kCorePatience
// or the core thread lacks the memory for it.
// Must not be called on the core thread.
template <typename Question>
auto AskCore(CoreThread& core, Question question)
    -> std::optional<decltype(question(std::declval<CoreContext&>()))> {
  using Answer = decltype(question(std::declval<CoreContext&>()));
  // Shared: the core thread may answer after the caller has stopped waiting.
  const auto promise = std::make_shared<std::promise<std::optional<Answer>>>();
  auto answer = promise->get_future();
  core.Post([promise, question](CoreContext& context) {
    std::optional<Answer> found;
    try {
      found.emplace(question(context));
    } catch (const std::exception&) {
      // The caller does not wait in vain.
    }
    promise->set_value(std::move(found));
  });
  if (answer.wait_for(kCorePatience) != std::future_status::ready) return std::nullopt;
  return answer.get();
}

}  // namespace tessera
