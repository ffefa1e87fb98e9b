// What the programs need of the processor: x86-64-v3 (AVX2, FMA, BMI2 and more), for which everything is
// compiled.
#pragma once

namespace tessera {

// Ends the process with a message if the processor lacks it. That happens by itself before anything else of
// the program runs; call it at the start of main, so that the linker does not leave the check out.
void RequireProcessor();

}  // namespace tessera
