// The commands of `tessera`. To add one, write its file and name it in the two lists here.
#pragma once

#include "client/commands/command.h"

namespace tessera {

// Each is defined in the file of its name.
Command AccessCommand();
Command BenchCommand();
Command CancelCommand();
Command CompareCommand();
Command CompletionCommand();
Command DenoiseCommand();
Command DoctorCommand();
Command DrainCommand();
Command ExtendCommand();
Command FetchCommand();
Command InfoCommand();
Command JobsCommand();
Command KindsCommand();
Command LoginCommand();
Command LogoutCommand();
Command LogsCommand();
Command ManCommand();
Command PauseCommand();
Command PriorityCommand();
Command ReleaseCommand();
Command RelightCommand();
Command RenderCommand();
Command ResumeCommand();
Command StatusCommand();
Command SubmitCommand();
Command TopCommand();
Command WatchCommand();
Command WorkersCommand();

// In the order in which the help lists them.
using MakeCommandFunction = Command (*)();
inline constexpr MakeCommandFunction kCommands[] = {
    // On this machine.
    RenderCommand, InfoCommand, KindsCommand, CompareCommand, DenoiseCommand, RelightCommand, BenchCommand,
    // Jobs of a farm.
    SubmitCommand, JobsCommand, StatusCommand, WatchCommand, LogsCommand, FetchCommand, ExtendCommand,
    PriorityCommand, PauseCommand, ResumeCommand, CancelCommand,
    // Workers of a farm.
    WorkersCommand, DrainCommand, ReleaseCommand, TopCommand,
    // Who belongs to a farm.
    LoginCommand, LogoutCommand, AccessCommand, DoctorCommand,
    // This program.
    CompletionCommand, ManCommand};

std::vector<Command> AllCommands();

}  // namespace tessera
