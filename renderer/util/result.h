// Result<T>: a value, or the reason why there is none. Used for everything that a healthy system meets: user
// input, files, the network, the disk. What cannot happen is checked with TESSERA_CHECK (check.h) instead.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "renderer/util/check.h"

namespace tessera {

// What a program answers with when an error ends it (DESIGN.md section 8).
enum class ErrorKind {
  kFailed = 1,        // the render, the farm, the disk or the network failed
  kBadInput = 2,      // usage, scene or any other input is wrong
  kInterrupted = 130  // the user asked to stop
};

// Why something could not be done. `message` names the object and its place and says what to do; it is one
// line.
struct Error {
  ErrorKind kind = ErrorKind::kFailed;
  std::string message;
};

inline Error BadInput(std::string message) {
  return {ErrorKind::kBadInput, std::move(message)};
}
inline Error Failed(std::string message) {
  return {ErrorKind::kFailed, std::move(message)};
}

// Members are named as those of std::expected.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  T& value() & {
    TESSERA_CHECK(has_value());
    return std::get<0>(state_);
  }
  const T& value() const& {
    TESSERA_CHECK(has_value());
    return std::get<0>(state_);
  }
  T&& value() && {
    TESSERA_CHECK(has_value());
    return std::get<0>(std::move(state_));
  }
  const Error& error() const {
    TESSERA_CHECK(!has_value());
    return std::get<1>(state_);
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  const Error& error() const {
    TESSERA_CHECK(error_.has_value());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace tessera
