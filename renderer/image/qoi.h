// "Quite OK Image" files (qoiformat.org, specification of 2022-01-05).
#pragma once

#include "renderer/image/image.h"

namespace tessera {

// Channels R G B or R G B A. The encoding of the header is used unless one is given.
Result<Image> DecodeQoi(const std::string& bytes, const std::string& name,
                        std::optional<ColorEncoding> encoding);

}  // namespace tessera
