// How a terminal can show pictures, which it is asked.
#pragma once

#include <chrono>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

namespace tessera {

enum class Graphics {
  kKitty,      // the graphics protocol of kitty: pixels, 24 bits
  kSixel,      // DEC's sixels: pixels, a palette
  kTrueColor,  // two pixels in each character cell: U+2580 in 24-bit colours
  kColors256,  // the same in the palette of 256 colours
  kShades,     // one pixel in each character cell: characters of different darkness, no colours
};

struct TerminalGraphics {
  Graphics kind = Graphics::kShades;
  int cell_width = 10, cell_height = 20;  // pixels
};

// The question that terminals answer: whether they know kitty's protocol, the size of a cell, and what they
// are (Primary Device Attributes), which all terminals answer, in this order.
std::string GraphicsQuestion();

// What a terminal has answered so far.
struct GraphicsAnswer {
  bool is_complete = false;  // it has said what it is
  bool has_kitty = false, has_sixel = false;
  int cell_width = 0, cell_height = 0;  // 0: not known
};
GraphicsAnswer ReadGraphicsAnswer(std::string_view bytes);

using Variable = std::function<std::string(const char* name)>;  // of the environment; empty: not set

// What is used without an answer: by $TERM, $COLORTERM, $NO_COLOR and the locale.
Graphics GraphicsOf(const Variable& environment);

// Asks the terminal of the standard input and output, which must not echo (Screen), and waits at most for
// `patience`. Terminals that do not answer, and those that are told to show no colours, are not asked for
// more than `environment` says.
TerminalGraphics AskTerminal(const Variable& environment, std::chrono::milliseconds patience,
                             const std::stop_token& stop);

}  // namespace tessera
