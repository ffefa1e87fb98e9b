// The one way in which commands write files that users name.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "renderer/util/result.h"

namespace tessera {

// What becomes of a regular file that exists.
enum class Existing { kReplace, kKeep };

// Writes `bytes` to `path`. Links are followed. A new file appears at its name only when it is whole. An
// existing file keeps its mode and owner and is replaced by a whole one; it is written in place if it has
// several names (hard links), if its owner cannot be kept, or if its folder permits no new file. Pipes,
// character devices and open files such as - and /dev/stdout are written to as a stream; a pipe without a
// reader is waited for. Refuses whatever ExamineOutput refuses. Returns kInterrupted if a stop is requested
// while it waits for a reader. Errors name `path`.
// With kKeep, a regular file that exists, or that another program makes meanwhile, is an error.
Result<void> WriteOutput(const std::string& path, std::string_view bytes, std::stop_token stop,
                         Existing existing = Existing::kReplace);

// The error of a file that exists and is to be kept.
Error ExistsAlready(const std::string& path);

// Whether `path` is the standard output of this program, which then prints nothing else there.
bool IsStandardOutput(const std::string& path);

}  // namespace tessera
