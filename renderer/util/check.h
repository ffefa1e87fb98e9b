// TESSERA_CHECK(condition): stops the program with the place and the condition when the impossible has
// happened. Always on: a wrong picture costs more than a branch. Not for user input, files or the network
// (see result.h).
#pragma once

namespace tessera {

[[noreturn]] void CheckFailed(const char* file, int line, const char* condition);

}  // namespace tessera

#define TESSERA_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::tessera::CheckFailed(__FILE__, __LINE__, #condition))
