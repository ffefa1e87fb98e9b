// The processor features that the programs need: x86-64-v3 (AVX2, FMA, BMI2 and more), for which everything
// is compiled.
#pragma once

namespace tessera {

// Ends the process with a message if the processor lacks one of them. The check runs by itself before
// anything else of the program; call it at the start of main, so that the linker keeps it.
void RequireProcessor();

}  // namespace tessera
