// A picture as what a terminal is sent to draw it at the cursor. Each ends with the cursor somewhere below or
// behind the picture.
#pragma once

#include <string>
#include <vector>

#include "client/live/small_picture.h"
#include "client/live/terminal_graphics.h"

namespace tessera {

// Lines of character cells: two pixels one above the other in each, with kTrueColor or kColors256, or one
// pixel with kShades. Lines end with the colours of the terminal.
std::vector<std::string> CellLines(const SmallPicture& picture, Graphics kind);

// One sixel sequence. Colours are those of a cube of 6 x 6 x 6, mixed by ordered dithering.
std::string SixelText(const SmallPicture& picture);

// Replaces the picture that this function drew before. It covers `columns` x `rows` cells; the cursor stays.
std::string KittyText(const SmallPicture& picture, int columns, int rows);
// Removes it.
std::string KittyRemoval();

}  // namespace tessera
