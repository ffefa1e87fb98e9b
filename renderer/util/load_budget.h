// What loading one scene may use: a scene that would exhaust the machine fails instead.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <new>
#include <string>

namespace tessera {

// Thrown by allocations and by CheckLoadBudget once a budget is exceeded, for whoever loads the scene. Its
// text is for messages of those who catch it on the way; the budget knows the reason.
class LoadBudgetExceeded : public std::bad_alloc {
 public:
  const char* what() const noexcept override { return "the scene exceeds the limits of loading"; }
};

// For small allocations after a budget is exceeded, such as those of error messages.
constexpr int64_t kLoadSlackBytes = int64_t{64} << 20;

// Thread safe, except for Scope.
class LoadBudget {
 public:
  // `exceeded_reason` explains the limit.
  LoadBudget(uint64_t bytes_max, std::string exceeded_reason)
      : bytes_max_(static_cast<int64_t>(bytes_max)), exceeded_reason_(std::move(exceeded_reason)) {}
  LoadBudget(const LoadBudget&) = delete;
  LoadBudget& operator=(const LoadBudget&) = delete;

  // Takes `bytes` from the budget, or gives them back if negative. Returns false, and takes nothing, if they
  // are too many or loading was cancelled.
  bool Charge(int64_t bytes) {
    if (bytes > 0 && is_exceeded_) return false;
    if (bytes_.fetch_add(bytes) + bytes <= bytes_max_ || bytes <= 0) return true;
    bytes_ -= bytes;
    Cancel(exceeded_reason_);
    return false;
  }
  // Takes a little more, up to kLoadSlackBytes, of a budget that is exceeded. Returns false beyond that.
  bool ChargeSmall(int64_t bytes) {
    if (bytes_.fetch_add(bytes) + bytes <= bytes_max_ + kLoadSlackBytes) return true;
    bytes_ -= bytes;
    return false;
  }
  // Ends loading as soon as possible. The first reason is kept.
  void Cancel(const std::string& reason);
  bool is_exceeded() const { return is_exceeded_; }
  // Call only if exceeded.
  std::string reason() const;

  // The budget of this thread, or null.
  static LoadBudget* Current() { return current_; }
  // Makes a budget that of this thread as long as it lives.
  class Scope {
   public:
    explicit Scope(LoadBudget& budget) { current_ = &budget; }
    ~Scope() { current_ = nullptr; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
  };

 private:
  static inline constinit thread_local LoadBudget* current_ = nullptr;

  const int64_t bytes_max_;
  const std::string exceeded_reason_;
  std::atomic<int64_t> bytes_ = 0;
  std::atomic<bool> is_exceeded_ = false;
  mutable std::mutex mutex_;
  std::string reason_;  // guarded by mutex_
};

// Throws LoadBudgetExceeded if the budget of this thread is exceeded. For loops whose length a scene decides.
inline void CheckLoadBudget() {
  const LoadBudget* const budget = LoadBudget::Current();
  if (budget != nullptr && budget->is_exceeded()) throw LoadBudgetExceeded();
}

}  // namespace tessera
