// What a process costs beside its time: memory, and instructions, which do not depend on what else runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Megabytes: the most memory that this process has held since it started or ResetPeakMemory was called.
double PeakMemory();
// Gives unused memory back to the system first. Does nothing where the kernel does not allow it.
void ResetPeakMemory();

// Runs this program with `arguments` under valgrind, on one thread, and returns the number of instructions
// that it executes. An error if valgrind is not installed or the program fails.
Result<uint64_t> CountInstructions(const std::vector<std::string>& arguments);

// The number of instructions that the output of cachegrind states; 0 if it states none.
uint64_t ReadInstructionCount(const std::string& output);

}  // namespace tessera
