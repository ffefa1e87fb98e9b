// The names of the layers that may be added to a picture, in order; layers.cpp says what each holds.
#pragma once

#include <string_view>

namespace tessera {

constexpr std::string_view kLayerNames[] = {"samples",       "albedo",          "normal",      "depth",
                                            "crypto_object", "crypto_material", "crypto_asset"};

}  // namespace tessera
