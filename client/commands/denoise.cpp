// tessera denoise
#include "renderer/denoise/denoise.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <set>
#include <vector>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/frame_name.h"
#include "client/frame_range.h"
#include "client/output/exr_encoder.h"
#include "client/output/output_target.h"
#include "client/picture_names.h"
#include "client/saved_picture.h"
#include "proto/shell/console.h"
#include "renderer/util/cores.h"

namespace tessera {
namespace {

constexpr int kThreadsMax = 1024;  // more is a typing mistake

struct DenoiseOptions {
  std::string picture;  // path, or for a sequence a FrameName
  OutputOptions output;
  std::optional<FrameRange> frames;
  ExrType exr_type = ExrType::kHalf;
  int threads = 0;  // 0: all cores
  bool json = false;
};

void AddDenoiseFlags(CLI::App& app, DenoiseOptions& options) {
  AddText(app, "PICTURE", "", "EXR file that was rendered with --aov denoise", options.picture,
          Presence::kRequired);
  AddOutputFlags(app, options.output, "denoised.exr");
  AddValue(app, "--frames", "A-B[xSTEP]", "Denoise the frames of a sequence (picture.####.exr)",
           options.frames, ParseFrameRange);
  AddValue(app, "--exr-type", "half|float",
           WithDefault("Precision of the colours; other layers are always 32-bit floats", "half"),
           options.exr_type, ParseExrType);
  AddInteger(app, "--threads", WithDefault("Threads", "all cores"), 1, kThreadsMax, options.threads);
  AddJsonFlag(app, options.json);
}

Result<void> CheckDenoiseOptions(const DenoiseOptions& options) {
  if (options.json && TakesStandardOutput(options.output))
    return BadInput("the standard output cannot take both a picture and the answer of --json");
  if (options.frames && !FrameName(options.picture).HasPlace()) {
    return BadInput(fmt::format("{}: the name of a sequence has #### or %04d for the number of the frame",
                                options.picture));
  }
  return {};
}

Result<SavedPicture> DenoiseFrame(const DenoiseOptions& options, const std::string& input, int frame,
                                  const PictureNames& names, const std::stop_token& stop) {
  const auto picture = LoadExr(input);
  if (!picture) return picture.error();
  const int threads = options.threads > 0 ? options.threads : UsableCores();
  const auto denoised = Denoise(*picture, input, threads, stop);
  if (!denoised) return denoised.error();
  const auto exr = EncodeLoaded(*denoised, options.exr_type, names.Picture(frame));
  if (!exr) return exr.error();
  return SavePicture(*exr, frame, names, stop);
}

Result<int> RunDenoise(const DenoiseOptions& options, Cancellation& cancellation) {
  using Numbers = PictureNames::Numbers;
  const auto start = std::chrono::steady_clock::now();
  const FrameName input(options.picture);
  const bool is_sequence = options.frames.has_value();
  const std::vector<int> numbers = is_sequence ? options.frames->Numbers() : std::vector<int>{0};
  const auto input_of = [&](int frame) { return is_sequence ? input.Of(frame) : options.picture; };
  const std::string output = options.output.picture.empty() ? "denoised.exr" : options.output.picture;
  const PictureNames names(output, options.output.png, is_sequence ? Numbers::kAlways : Numbers::kNone);
  std::set<std::string> inputs;
  for (const int frame : numbers) inputs.insert(input_of(frame));
  if (auto writable = names.Check(numbers, inputs); !writable) return writable.error();
  std::vector<SavedPicture> saved;
  for (const int frame : numbers) {
    auto picture = DenoiseFrame(options, input_of(frame), frame, names, cancellation.token());
    if (!picture) return picture.error();
    saved.push_back(std::move(*picture));
    PrintNote("{}: denoised\n", ShownPath(saved.back().path));
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) fmt::print("{}\n", PicturesJson(saved, is_sequence, seconds));
  return 0;
}

}  // namespace

Command DenoiseCommand() {
  return MakeCommand<DenoiseOptions>({
      .name = "denoise",
      .summary = "Remove the noise of a rendered picture",
      .examples = {{"Denoise a picture", "tessera denoise picture.exr -o denoised.exr --png denoised.png"},
                   {"Denoise a sequence",
                    "tessera denoise 'shot.####.exr' --frames 1-240 -o 'clean.####.exr'"}},
      .add_flags = AddDenoiseFlags,
      .check = CheckDenoiseOptions,
      .run = RunDenoise,
  });
}

}  // namespace tessera
