// The whole terminal, as programs like top(1) use it.
#pragma once

#include <termios.h>

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// Shows lines on the terminal of the standard output until it is destroyed, which gives the terminal back as
// it was. Ctrl-C still sends its signal. One at a time.
class Screen {
 public:
  // Whether the standard output and input are a terminal.
  static bool IsAvailable();
  Screen();
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  // The first line and those in capitals are emphasised, unless $NO_COLOR is set.
  void Show(const std::vector<std::string>& lines);
  // Writes text with control sequences, as it is, whether a screen is in use or not.
  static void Write(std::string_view text);
  // A key that was pressed and not read yet. Keys that send a sequence, such as arrows, are skipped.
  std::optional<char> ReadKey();
  // Waits for a key, at most for `patience` or until a stop is requested.
  std::optional<char> AwaitKey(std::chrono::milliseconds patience, const std::stop_token& stop);

 private:
  termios before_{};
  const bool is_plain_;
};

}  // namespace tessera
