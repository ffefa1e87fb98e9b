// The main function of every program: signals, exceptions, error messages and exit codes (DESIGN.md section
// 8).
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "renderer/util/result.h"

namespace tessera {

// Open files that every program needs: gRPC ends the process if it finds no descriptor when it starts.
constexpr uint64_t kDescriptorsMin = 64;

// What a program does with its arguments (without the program's name). A stop of the token means that the
// user or the system wants the program to end. Returns the exit code or the error that ended the program.
using ProgramBody =
    std::function<Result<int>(const std::vector<std::string>& arguments, std::stop_token termination)>;

// Runs `body` and returns the exit code. The first signal that asks the program to end (TerminationSignals)
// requests a stop of the token; the second ends the process immediately, with exit code 130. An error, an
// exception such as std::bad_alloc, or a system that grants too few threads or descriptors is reported with
// the program's name on stderr. Overwrites join tokens in `argv`. Call it from main before any thread is
// started.
int RunProgram(const std::string& name, int argc, char** argv, const ProgramBody& body);

// From now on an exception that no thread catches, such as std::bad_alloc, ends the process with a message
// and exit code 1. RunProgram calls it.
void ReportUncaughtExceptions(const std::string& name);

// Prints "NAME: MESSAGE" on one line of stderr. Returns the exit code of the error.
int Report(const std::string& name, const Error& error);

// The value of an environment variable; empty if it is not set.
std::string Environment(const char* variable);

}  // namespace tessera
