// The program of tests/fuzz/run: libFuzzer with all targets, of which the option --target=NAME chooses one.
// libFuzzer ignores options with two dashes.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/targets.h"

namespace {

const tessera::FuzzTarget* chosen_target = nullptr;

}  // namespace

// The names that libFuzzer looks for.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (!argument.starts_with(kOption)) continue;
    for (const tessera::FuzzTarget& target : tessera::FuzzTargets()) {
      if (argument.substr(kOption.size()) == target.name) chosen_target = &target;
    }
  }
  if (chosen_target != nullptr) {
    if (chosen_target->prepare != nullptr) chosen_target->prepare();
    return 0;
  }
  std::fputs("fuzzer: --target=NAME must name one of these targets:\n", stderr);
  for (const tessera::FuzzTarget& target : tessera::FuzzTargets()) std::fprintf(stderr, "%s\n", target.name);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  chosen_target->read({reinterpret_cast<const char*>(data), size});
  return 0;
}
