// Join tokens as words of the command line. Other users of the machine see the words of every process, and
// the shell keeps them in its history, so a token can also be given on standard input.
#pragma once

#include <stop_token>
#include <string>

#include "renderer/util/result.h"

namespace tessera {

// Overwrites the join tokens among the arguments of main: they are no longer in the list of processes.
// RunProgram calls it.
void HideTokens(int argc, char** argv);

// The word itself, or, if it is "-", the first line of standard input without white space at its ends. An
// error if there is no line, if it cannot be a token, or (kInterrupted) if a stop is requested while it is
// awaited.
Result<std::string> WordOrInput(const std::string& word, const std::stop_token& stop);

}  // namespace tessera
