#include "client/screen.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "proto/shell/program.h"
#include "renderer/util/file_descriptor.h"

namespace tessera {
namespace {

constexpr int kKeySlice_ms = 100;  // how long a stop may go unnoticed

bool IsHeading(const std::string& line) {
  return !line.empty() && std::ranges::all_of(line, [](unsigned char c) { return std::isupper(c) != 0; });
}

}  // namespace

// A terminal that is gone is noticed by its SIGHUP.
void Screen::Write(std::string_view text) {
  WriteAll(STDOUT_FILENO, text);
}

bool Screen::IsAvailable() {
  return ::isatty(STDOUT_FILENO) == 1 && ::isatty(STDIN_FILENO) == 1;
}

Screen::Screen() : is_plain_(!Environment("NO_COLOR").empty()) {
  ::tcgetattr(STDIN_FILENO, &before_);
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  Write("\x1b[?1049h\x1b[?25l");  // the other screen, without a cursor
}

Screen::~Screen() {
  Write("\x1b[?25h\x1b[?1049l");
  ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
}

void Screen::Show(const std::vector<std::string>& lines) {
  std::string text = "\x1b[H";
  for (size_t i = 0; i < lines.size(); ++i) {
    const bool is_strong = !is_plain_ && (i == 0 || IsHeading(lines[i]));
    text += (is_strong ? "\x1b[1m" + lines[i] + "\x1b[0m" : lines[i]) + "\x1b[K";
    if (i + 1 < lines.size()) text += "\r\n";
  }
  Write(text + "\x1b[J");
}

std::optional<char> Screen::ReadKey() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char bytes[32];
  if (::poll(&input, 1, 0) <= 0) return std::nullopt;
  const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
  // An arrow or a function key sends an escape sequence.
  if (count < 1 || (count > 1 && bytes[0] == '\x1b')) return std::nullopt;
  return bytes[0];
}

std::optional<char> Screen::AwaitKey(std::chrono::milliseconds patience, const std::stop_token& stop) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!stop.stop_requested() && std::chrono::steady_clock::now() < deadline) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, kKeySlice_ms) <= 0) continue;
    if (const auto key = ReadKey()) return key;
  }
  return std::nullopt;
}

}  // namespace tessera
