// Which of the allowed formats a file holds.
#pragma once

#include <string_view>

namespace tessera {

enum class ImageFormat { kUnknown, kExr, kPng, kJpeg, kTga, kHdr, kTiff, kBmp, kWebp, kPfm, kQoi };

// By the first bytes; a TGA, which has no magic number, by its ending or its footer.
ImageFormat FormatOfContent(std::string_view bytes, std::string_view name);
// By the ending of the name; kUnknown for any other ending.
ImageFormat FormatOfEnding(std::string_view name);
// "PNG", for messages.
std::string_view FormatName(ImageFormat format);
// Whether a name ends in `ending` (with its dot), in any case.
bool HasEnding(std::string_view name, std::string_view ending);

}  // namespace tessera
