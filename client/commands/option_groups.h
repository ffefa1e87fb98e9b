// Flags that several commands share: for each group its options and a function that adds the flags to a
// command.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/coordinator/coordinator_client.h"
#include "client/coordinator/farm_choice.h"
#include "client/output/layer_files.h"
#include "client/scene_options.h"
#include "proto/shell/flags.h"
#include "proto/terms.h"

namespace tessera {

// SCENE, and what flags override of its frames.
void AddSceneFlags(CLI::App& app, SceneOptions& options);

// --scene-memory, as a command describes it that loads scenes here, and perhaps in workers.
void AddSceneMemoryFlag(CLI::App& app, SceneOptions& options, const std::string& description,
                        const std::string& default_text);
// The same of a command that loads scenes here alone.
void AddSceneMemoryFlag(CLI::App& app, SceneOptions& options);

// --spp of a command that has no other render options and cannot do without it.
void AddRequiredSamples(CLI::App& app, uint32_t& samples_per_pixel);

// Which coordinator a command calls.
struct ConnectionOptions {
  FarmChoice farm;
  Patience patience;
};
// Certificates of an organisation. The defaults come from the environment.
void AddTlsFlags(CLI::App& app, TlsFiles& files);
// The defaults come from the environment, or are constants.
void AddConnectionFlags(CLI::App& app, ConnectionOptions& options);

// Where a picture is written.
struct OutputOptions {
  std::string picture;      // path, or for a sequence a FrameName; empty: the command chooses one
  std::string png;          // the same of a tone-mapped copy; empty: none
  bool no_clobber = false;  // existing files are not replaced
  ExrOutput exr;
};
// Whether a picture is written to the standard output of this program, which then prints nothing else there.
bool TakesStandardOutput(const OutputOptions& options);
// `default_name` describes in the help what the command chooses.
void AddOutputFlags(CLI::App& app, OutputOptions& options, const std::string& default_name);

// Fails if the picture's format cannot hold what the options ask for.
Result<void> CheckPictureOptions(const RenderOptions& render, const OutputOptions& output);

void AddJobArgument(CLI::App& app, JobId& job);
// A job that need not be named (default_job.h).
void AddDefaultJobArgument(CLI::App& app, std::optional<JobId>& job);
// Some jobs, likewise. Each is kept once.
void AddJobsArgument(CLI::App& app, std::vector<JobId>& jobs);
void AddJsonFlag(CLI::App& app, bool& json);
// Print a forecast instead of doing anything.
void AddDryRunFlag(CLI::App& app, bool& dry_run);
// A command to run when a job has ended.
void AddNotifyFlag(CLI::App& app, std::string& command);
// The part of the picture that is rendered before the rest.
void AddFirstFlag(CLI::App& app, std::optional<Region>& first);
// Fails if nothing of the region is rendered in any of the frames.
Result<void> CheckFirst(const std::optional<Region>& first, const std::vector<FrameRequest>& frames);
// The share of units that two workers render and must agree on.
void AddVerifyFlag(CLI::App& app, double& share);

}  // namespace tessera
