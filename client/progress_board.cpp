#include "client/progress_board.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "client/terminal.h"
#include "proto/shell/console.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kBoardInterval{200}, kBoardLogInterval{5000};

}  // namespace

ProgressBoard::ProgressBoard()
    : terminal_(::isatty(STDERR_FILENO) == 1), next_(std::chrono::steady_clock::now()) {}

ProgressBoard::~ProgressBoard() {
  const std::lock_guard lock(mutex_);
  terminal_ ? WriteTerminal() : WriteLog();
}

void ProgressBoard::Show(JobId job, const std::string& line, bool has_ended) {
  const std::lock_guard lock(mutex_);
  Line& mine = lines_[job];
  mine.is_new = mine.is_new || mine.text != line;
  mine.text = line;
  mine.has_ended = has_ended;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_ && !has_ended) return;
  next_ = now + (terminal_ ? kBoardInterval : kBoardLogInterval);
  terminal_ ? WriteTerminal() : WriteLog();
}

void ProgressBoard::WriteTerminal() {
  const TerminalSize size = TerminalSizeOf(STDERR_FILENO);
  const int room = std::max(size.rows - 2, 1);
  std::string text = rows_ > 0 ? fmt::format("\x1b[{}A", rows_) : "";
  rows_ = 0;
  for (const auto& [job, line] : lines_) {
    if (rows_ == room) {
      text += fmt::format("\rand {} more\x1b[K\n", lines_.size() - static_cast<size_t>(room));
      ++rows_;
      break;
    }
    text += "\r" + FirstColumns(line.text, size.columns - 1) + "\x1b[K\n";
    ++rows_;
  }
  WriteToConsole(text);
}

void ProgressBoard::WriteLog() {
  std::string text;
  for (auto& [job, line] : lines_) {
    if (std::exchange(line.is_new, false)) text += line.text + "\n";
  }
  WriteToConsole(text);
}

}  // namespace tessera
