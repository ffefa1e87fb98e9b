// tessera denoise
#include "renderer/denoise/denoise.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/output/layer_files.h"
#include "client/output/output_target.h"
#include "client/picture_names.h"
#include "client/saved_picture.h"
#include "proto/frame_name.h"
#include "proto/frame_range.h"
#include "proto/shell/console.h"
#include "renderer/denoise/temporal.h"
#include "renderer/film/picture_file.h"
#include "renderer/util/cores.h"

namespace tessera {
namespace {

constexpr int kThreadsMax = 1024;  // more is a typing mistake

struct DenoiseOptions {
  std::string picture;  // path, or for a sequence a FrameName
  OutputOptions output;
  std::optional<FrameRange> frames;
  bool is_alone = false;  // each frame of a sequence
  Denoiser denoiser = Denoiser::kRegression;
  std::optional<ExrType> exr_type;  // of the colours; none: as in the picture
  int threads = 0;                  // 0: all cores
  bool json = false;
};

void AddDenoiseFlags(CLI::App& app, DenoiseOptions& options) {
  AddText(app, "PICTURE", "", "EXR file that was rendered with --aov denoise", options.picture,
          Presence::kRequired);
  AddOutputFlags(app, options.output, "denoised.exr");
  AddValue(app, "--frames", "A-B[xSTEP]", "Denoise the frames of a sequence (picture.####.exr)",
           options.frames, ParseFrameRange);
  AddSwitch(app, "--no-temporal",
            "Denoise each frame of a sequence alone instead of with its neighbours, which the layer motion "
            "leads to",
            options.is_alone);
  AddValue(app, "--exr-type", "half|float",
           WithDefault("Type of the colours in the EXR file: half or float", "that of PICTURE"),
           options.exr_type, ParseExrType);
  AddValue(
      app, "--denoiser", "NAME",
      WithDefault("Denoise with: regression, or oidn (Open Image Denoise, if it is installed)", "regression"),
      options.denoiser, ParseDenoiser);
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

// Whether the channel is one of the colours, or of the light of a group, noisy or not.
bool IsDenoised(const std::string& channel) {
  const size_t dot = channel.rfind('.');
  const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
  const bool is_light = layer.starts_with("light_") || layer.starts_with(NoisyLayerOf("light_"));
  return is_light || ((layer.empty() || layer == kNoisyLayer) && IsColorChannel(channel.substr(dot + 1)));
}

void SetColorType(ExrType type, LoadedPicture& picture) {
  picture.types.resize(picture.channels.size(), ExrType::kFloat);
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    if (IsDenoised(picture.channels[c])) picture.types[c] = type;
  }
}

// Denoises frames one after another. Up to three are in memory.
class FrameDenoiser {
 public:
  FrameDenoiser(const DenoiseOptions& options, const PictureNames& names, std::stop_token stop)
      : options_(options),
        names_(names),
        stop_(std::move(stop)),
        threads_(options.threads > 0 ? options.threads : UsableCores()) {
    UseThreadsForPictures(threads_);
  }

  // The frames must be loaded in order.
  Result<DenoisedFrame> Load(const std::string& input) const {
    auto picture = LoadExr(input);
    if (!picture) return picture.error();
    return DenoiseAlone(std::move(picture).value(), input, threads_, stop_, options_.denoiser);
  }
  Result<SavedPicture> Save(const DenoisedFrame* before, const DenoisedFrame& frame,
                            const DenoisedFrame* after, int number) const {
    auto denoised = BlendFrames(before, frame, after, threads_, stop_);
    const std::string path = names_.Picture(number);
    if (!denoised) return Error{denoised.error().kind, fmt::format("{}: {}", path, denoised.error().message)};
    if (options_.exr_type) SetColorType(*options_.exr_type, *denoised);
    const auto exr = EncodeExr(*denoised, denoised->format);
    if (!exr) return Error{exr.error().kind, fmt::format("{}: {}", path, exr.error().message)};
    auto saved = SavePicture(*exr, number, names_, stop_);
    if (saved) PrintNote("{}: denoised\n", ShownPath(saved->path));
    return saved;
  }

 private:
  const DenoiseOptions& options_;
  const PictureNames& names_;
  const std::stop_token stop_;
  const int threads_;
};

// Saves every frame that comes before one that cannot be loaded.
template <typename InputOf>
Result<std::vector<SavedPicture>> DenoiseFrames(const FrameDenoiser& denoiser,
                                                const std::vector<int>& numbers, const InputOf& input_of,
                                                bool is_blended) {
  std::vector<SavedPicture> saved;
  std::optional<DenoisedFrame> before, frame;
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (!frame) {
      auto first = denoiser.Load(input_of(numbers[i]));
      if (!first) return first.error();
      frame = std::move(*first);
    }
    std::optional<Result<DenoisedFrame>> after;
    if (is_blended && i + 1 < numbers.size()) after = denoiser.Load(input_of(numbers[i + 1]));
    const DenoisedFrame* const next = after && *after ? &**after : nullptr;
    auto picture = denoiser.Save(before ? &*before : nullptr, *frame, next, numbers[i]);
    if (!picture) return picture.error();
    saved.push_back(std::move(*picture));
    if (after && !*after) return after->error();
    std::optional<DenoisedFrame> saved_frame = std::exchange(frame, std::nullopt);
    before = is_blended ? std::move(saved_frame) : std::nullopt;
    if (after) frame = std::move(**after);
  }
  return saved;
}

// The layers that get files of their own; empty if all are in one. Frames of a sequence have the same.
Result<std::set<std::string>> LayerFiles(const DenoiseOptions& options, const std::string& input) {
  std::set<std::string> files;
  if (!options.output.exr.splits_layers) return files;
  const auto picture = LoadExr(input);
  if (!picture) return picture.error();
  files.insert(kNoisyLayer);
  for (const std::string& channel : picture->channels) {
    const std::string layer = LayerOf(channel, {});
    if (layer.empty()) continue;
    files.insert(FileLayer(layer));
    if (layer.starts_with("light_")) files.insert(FileLayer(NoisyLayerOf(layer)));
  }
  return files;
}

Result<int> RunDenoise(const DenoiseOptions& options, Cancellation& cancellation) {
  using Numbers = PictureNames::Numbers;
  const auto start = std::chrono::steady_clock::now();
  const FrameName input(options.picture);
  const bool is_sequence = options.frames.has_value();
  const std::vector<int> numbers = is_sequence ? options.frames->Numbers() : std::vector<int>{0};
  const auto input_of = [&](int frame) { return is_sequence ? input.Of(frame) : options.picture; };
  const std::string output = options.output.picture.empty() ? "denoised.exr" : options.output.picture;
  PictureNames names(output, options.output.png, is_sequence ? Numbers::kAlways : Numbers::kNone,
                     options.output.no_clobber ? Existing::kKeep : Existing::kReplace);
  names.SetExrOutput(options.output.exr);
  std::set<std::string> inputs;
  for (const int frame : numbers) inputs.insert(input_of(frame));
  const auto layers = LayerFiles(options, input_of(numbers.front()));
  if (!layers) return layers.error();
  if (auto writable = names.Check(numbers, inputs, *layers); !writable) return writable.error();
  const FrameDenoiser denoiser(options, names, cancellation.token());
  const auto saved = DenoiseFrames(denoiser, numbers, input_of, is_sequence && !options.is_alone);
  if (!saved) return saved.error();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) fmt::print("{}\n", PicturesJson(*saved, is_sequence, seconds));
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
