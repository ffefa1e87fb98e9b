// tessera extend
#include "client/commands/commands.h"
#include "client/commands/job_command.h"

namespace tessera {
namespace {

struct ExtendOptions : JobOptions {
  uint32_t samples_per_pixel = 0;
};

void AddExtendFlags(CLI::App& app, ExtendOptions& options) {
  AddJobFlags(app, options);
  AddRequiredSamples(app, options.samples_per_pixel);
}

Result<int> RunExtend(const ExtendOptions& options, Cancellation& cancellation) {
  return RunJobCall(options, cancellation, [&](CoordinatorClient& client, JobId job) {
    return client.Extend(job, options.samples_per_pixel);
  });
}

}  // namespace

Command ExtendCommand() {
  return MakeCommand<ExtendOptions>({
      .name = "extend",
      .summary = "Add samples to a job that is running or finished",
      .examples = {{"Continue a finished job up to 1024 samples per pixel", "tessera extend 12 --spp 1024"}},
      .add_flags = AddExtendFlags,
      .run = RunExtend,
  });
}

}  // namespace tessera
