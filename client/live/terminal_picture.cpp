#include "client/live/terminal_picture.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "client/live/picture_text.h"
#include "proto/shell/program.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kAskPatience{1000};  // of terminals that are far away
constexpr int kPixelsMax = 1000;  // on a side, of pictures that are sent as pixels: half a megabyte of sixels

// Terminals that know it show what follows when it is complete.
constexpr const char* kUpdateStart = "\x1b[?2026h";
constexpr const char* kUpdateEnd = "\x1b[?2026l";

}  // namespace

TerminalScreen::TerminalScreen(const std::stop_token& stop, std::function<void()> on_quit)
    : on_quit_(std::move(on_quit)), size_(TerminalSizeOf(STDOUT_FILENO)) {
  screen_.emplace();
  graphics_ = AskTerminal([](const char* name) { return Environment(name); }, kAskPatience, stop);
}

TerminalScreen::~TerminalScreen() = default;

void TerminalScreen::ShowProgress(std::function<std::string(size_t columns)> text) {
  const std::lock_guard lock(mutex_);
  progress_ = std::move(text);
  DrawProgress();
}

void TerminalScreen::ShowPicture(const LoadedPicture& picture) {
  const std::lock_guard lock(mutex_);
  picture_ = picture;
  DrawPicture();
}

void TerminalScreen::Idle() {
  bool quits = false;
  {
    const std::lock_guard lock(mutex_);
    if (!screen_) return;
    while (const auto key = screen_->ReadKey()) quits = quits || *key == 'q' || *key == 'Q';
    const TerminalSize size = TerminalSizeOf(STDOUT_FILENO);
    if (size.columns != size_.columns || size.rows != size_.rows) {
      size_ = size;
      screen_->Write("\x1b[2J");
      DrawPicture();
      DrawProgress();
    }
  }
  if (quits) on_quit_();
}

void TerminalScreen::Close() {
  const std::lock_guard lock(mutex_);
  if (!screen_) return;
  if (graphics_.kind == Graphics::kKitty) screen_->Write(KittyRemoval());
  screen_.reset();
  if (!picture_) return;
  // Leaves room for what the command prints, and for the prompt.
  Screen::Write(PictureAt(size_, std::max(size_.rows - 4, 1), "\n"));
}

// Ends below the picture if `line_end` is not empty.
std::string TerminalScreen::PictureAt(const TerminalSize& size, int rows_max, const char* line_end) const {
  const int width = picture_->width, height = picture_->height;
  if (graphics_.kind == Graphics::kKitty || graphics_.kind == Graphics::kSixel) {
    const auto [across, down] =
        FittedSize(width, height, std::min(size.columns * graphics_.cell_width, kPixelsMax),
                   std::min(rows_max * graphics_.cell_height, kPixelsMax), false);
    const SmallPicture small = Shrink(*picture_, across, down);
    if (graphics_.kind == Graphics::kSixel) return SixelText(small) + line_end;
    const auto cells = [](int pixels, int cell) { return (pixels + cell - 1) / cell; };
    const int rows = cells(down, graphics_.cell_height);
    std::string text = KittyText(small, cells(across, graphics_.cell_width), rows);
    if (*line_end != '\0') {
      for (int row = 0; row < rows; ++row) text += line_end;
    }
    return text;
  }
  // A cell is about twice as high as it is wide.
  const bool is_shades = graphics_.kind == Graphics::kShades;
  auto [across, down] = FittedSize(width, height, size.columns, rows_max * 2, true);
  if (is_shades) down = std::max(down / 2, 1);
  std::string text;
  for (const std::string& line : CellLines(Shrink(*picture_, across, down), graphics_.kind))
    // The rest of the line is cleared first: after a full line, the cursor is still on its last cell.
    text += *line_end != '\0' ? line + line_end : "\x1b[K" + line + "\r\n";
  return text;
}

void TerminalScreen::DrawPicture() {
  if (!screen_ || !picture_) return;
  const int rows = std::max(size_.rows - 1, 1);
  screen_->Write(fmt::format("{}\x1b[H{}{}", kUpdateStart, PictureAt(size_, rows, ""), kUpdateEnd));
  DrawProgress();
}

void TerminalScreen::DrawProgress() {
  if (!screen_ || !progress_) return;
  const int columns = std::max(size_.columns - 1, 1);
  const std::string line = FirstColumns(progress_(static_cast<size_t>(columns)), columns);
  screen_->Write(fmt::format("\x1b[{};1H{}\x1b[K", size_.rows, line));
}

}  // namespace tessera
