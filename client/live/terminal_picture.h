// The picture of a job on the whole terminal, with its progress in the last line: watch --picture.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "client/live/picture_view.h"
#include "client/live/terminal_graphics.h"
#include "client/screen.h"
#include "client/terminal.h"

namespace tessera {

// Takes the terminal; gives it back when it is destroyed. Thread safe.
class TerminalScreen {
 public:
  // `on_quit` is called when q is pressed, on the thread that calls Idle.
  TerminalScreen(const std::stop_token& stop, std::function<void()> on_quit);
  ~TerminalScreen();
  // `text` gives a line without control characters for this many columns.
  void ShowProgress(std::function<std::string(size_t columns)> text);
  void ShowPicture(const LoadedPicture& picture);
  // Reads keys, and draws again if the terminal has another size.
  void Idle();
  // Ends the use of the whole terminal and leaves the last picture where the cursor is.
  void Close();

 private:
  void DrawPicture();
  void DrawProgress();
  std::string PictureAt(const TerminalSize& size, int rows_max, const char* line_end) const;

  std::mutex mutex_;
  const std::function<void()> on_quit_;
  std::optional<Screen> screen_;
  TerminalGraphics graphics_;
  TerminalSize size_;
  std::function<std::string(size_t columns)> progress_;
  std::optional<LoadedPicture> picture_;
};

// Shows pictures on a screen that outlives it.
class TerminalPicture : public PictureView {
 public:
  explicit TerminalPicture(TerminalScreen& screen) : screen_(screen) {}
  Result<void> Show(const LivePicture& picture, const std::stop_token&) override {
    screen_.ShowPicture(picture.picture);
    return {};
  }
  void Idle() override { screen_.Idle(); }

 private:
  TerminalScreen& screen_;
};

}  // namespace tessera
