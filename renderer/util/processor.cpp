// Compiled for the first x86-64 (renderer/CMakeLists.txt): nothing here may need what it checks for. So it
// uses no other code of Tessera and no template of the standard library.
#include "renderer/util/processor.h"

#include <cpuid.h>
#include <unistd.h>

namespace {

constexpr unsigned kFma = 1u << 12, kMovbe = 1u << 22, kOsXsave = 1u << 27, kAvx = 1u << 28,
                   kF16c = 1u << 29;                                   // 1:ecx
constexpr unsigned kBmi1 = 1u << 3, kAvx2 = 1u << 5, kBmi2 = 1u << 8;  // 7:ebx
constexpr unsigned kLzcnt = 1u << 5;                                   // ext:ecx
constexpr unsigned kVectorStates = 6;  // of xmm and ymm registers, saved by the system

bool SystemSavesVectors() {
  unsigned low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (low & kVectorStates) == kVectorStates;
}

// Intel 64 and AMD64 ABI, "Micro-architecture levels": level 3.
bool HasLevel3() {
  constexpr unsigned kOfLeaf1 = kFma | kMovbe | kOsXsave | kAvx | kF16c;
  constexpr unsigned kOfLeaf7 = kBmi1 | kAvx2 | kBmi2;
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid(1, &a, &b, &c, &d) == 0 || (c & kOfLeaf1) != kOfLeaf1 || !SystemSavesVectors())
    return false;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0 || (b & kOfLeaf7) != kOfLeaf7) return false;
  return __get_cpuid(0x80000001, &a, &b, &c, &d) != 0 && (c & kLzcnt) != 0;
}

// Before the constructors of all other files.
__attribute__((constructor(101))) void CheckProcessor() {
  tessera::RequireProcessor();
}

}  // namespace

namespace tessera {

void RequireProcessor() {
  if (HasLevel3()) return;
  static constexpr char kMessage[] =
      "tessera: this processor lacks x86-64-v3 (AVX2, FMA, BMI2): all machines of a farm need it, so that "
      "they compute the "
      "same bits\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  ::_exit(1);
}

}  // namespace tessera
