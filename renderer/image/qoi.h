// "Quite OK Image" files (qoiformat.org, specification of 2022-01-05).
#pragma once

#include "renderer/image/image.h"

namespace tessera {

// Channels R G B or R G B A. Without an encoding the header's is taken.
Result<Image> DecodeQoi(const std::string& bytes, const std::string& name,
                        std::optional<ColorEncoding> encoding);

}  // namespace tessera
