// Buffers compressed by Blosc 1 with LZ4, as OpenVDB writes them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

// The bytes that a buffer unpacks to if these are `size`. Returns nullopt if the buffer is damaged or was
// compressed in another way. Memory: the size.
std::optional<std::string> UnpackBlosc(std::string_view packed, size_t size);

// Appends what a block of LZ4 unpacks to until `out` has `size` bytes. Returns false if the block is damaged
// or unpacks to another size.
bool UnpackLz4(std::string_view packed, size_t size, std::string& out);

}  // namespace tessera
