#include "client/live/terminal_graphics.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <vector>

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kKittyId = "4711";  // of the question; any number
constexpr size_t kAnswerMax = 4096;       // bytes; answers have less than a hundred
constexpr int kCellMax = 1000;            // pixels on a side
constexpr int kSlice_ms = 50;             // how long a stop may go unnoticed
constexpr int kSixelAttribute = 4;

// The numbers of "1;22;333".
std::vector<int> Numbers(std::string_view text) {
  std::vector<int> numbers;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(';', begin), text.size());
    int number = 0;
    std::from_chars(text.data() + begin, text.data() + end, number);
    numbers.push_back(number);
    begin = end + 1;
  }
  return numbers;
}

// The parameters of the first answer "ESC [ PREFIX parameters FINAL".
std::string_view ParametersOf(std::string_view bytes, std::string_view prefix, char final) {
  const std::string start = "\x1b[" + std::string(prefix);
  for (size_t at = bytes.find(start); at != std::string_view::npos; at = bytes.find(start, at + 1)) {
    size_t end = at + start.size();
    while (end < bytes.size() &&
           (std::isdigit(static_cast<unsigned char>(bytes[end])) != 0 || bytes[end] == ';'))
      ++end;
    if (end < bytes.size() && bytes[end] == final)
      return bytes.substr(at + start.size(), end - at - start.size());
  }
  return {};
}

bool Contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

bool IsUtf8(const Variable& environment) {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    std::string locale = environment(name);
    if (locale.empty()) continue;
    std::ranges::transform(locale, locale.begin(), [](unsigned char c) { return std::tolower(c); });
    return Contains(locale, "utf-8") || Contains(locale, "utf8");
  }
  return false;
}

// What arrives until the answer is complete or there is no patience left.
std::string ReadAnswer(std::chrono::milliseconds patience, const std::stop_token& stop) {
  const auto deadline = Clock::now() + patience;
  std::string bytes;
  while (!stop.stop_requested() && Clock::now() < deadline && bytes.size() < kAnswerMax) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char part[256];
    if (::poll(&input, 1, kSlice_ms) <= 0) continue;
    const ssize_t count = ::read(STDIN_FILENO, part, sizeof part);
    if (count <= 0) break;
    bytes.append(part, static_cast<size_t>(count));
    if (ReadGraphicsAnswer(bytes).is_complete) break;
  }
  return bytes;
}

}  // namespace

std::string GraphicsQuestion() {
  return fmt::format("\x1b_Gi={},s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[16t\x1b[c", kKittyId);
}

GraphicsAnswer ReadGraphicsAnswer(std::string_view bytes) {
  GraphicsAnswer answer;
  answer.has_kitty = bytes.find(fmt::format("\x1b_Gi={};OK", kKittyId)) != std::string_view::npos;
  const std::vector<int> cell = Numbers(ParametersOf(bytes, "6;", 't'));
  const auto is_size = [](int size) { return size > 0 && size <= kCellMax; };
  if (cell.size() == 2 && is_size(cell[0]) && is_size(cell[1])) {
    answer.cell_height = cell[0];
    answer.cell_width = cell[1];
  }
  const std::string_view attributes = ParametersOf(bytes, "?", 'c');
  answer.is_complete = !attributes.empty();
  // The first number is the kind of the terminal.
  const std::vector<int> numbers = Numbers(attributes);
  answer.has_sixel = std::find(numbers.begin() + 1, numbers.end(), kSixelAttribute) != numbers.end();
  return answer;
}

Graphics GraphicsOf(const Variable& environment) {
  const std::string term = environment("TERM"), depth = environment("COLORTERM");
  if (!environment("NO_COLOR").empty() || term.empty() || !IsUtf8(environment)) return Graphics::kShades;
  if (depth == "truecolor" || depth == "24bit" || Contains(term, "direct") || Contains(term, "kitty"))
    return Graphics::kTrueColor;
  return Contains(term, "256color") ? Graphics::kColors256 : Graphics::kShades;
}

TerminalGraphics AskTerminal(const Variable& environment, std::chrono::milliseconds patience,
                             const std::stop_token& stop) {
  TerminalGraphics graphics{.kind = GraphicsOf(environment)};
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0 && window.ws_row > 0 &&
      window.ws_xpixel >= window.ws_col && window.ws_ypixel >= window.ws_row) {
    graphics.cell_width = window.ws_xpixel / window.ws_col;
    graphics.cell_height = window.ws_ypixel / window.ws_row;
  }
  const std::string term = environment("TERM");
  if (!environment("NO_COLOR").empty() || term.empty() || term == "dumb" || term == "linux") return graphics;
  const std::string question = GraphicsQuestion();
  if (::write(STDOUT_FILENO, question.data(), question.size()) < 0) return graphics;
  const GraphicsAnswer answer = ReadGraphicsAnswer(ReadAnswer(patience, stop));
  if (answer.cell_width > 0) {
    graphics.cell_width = answer.cell_width;
    graphics.cell_height = answer.cell_height;
  }
  if (answer.has_sixel) graphics.kind = Graphics::kSixel;
  if (answer.has_kitty) graphics.kind = Graphics::kKitty;
  return graphics;
}

}  // namespace tessera
