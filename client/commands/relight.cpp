// tessera relight
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/picture_names.h"
#include "client/saved_picture.h"
#include "renderer/film/relight.h"

namespace tessera {
namespace {

constexpr int kGainsMax = 256;  // channels that a picture can have

struct RelightOptions {
  std::string picture;
  std::vector<LightGain> gains;
  ExrType exr_type = ExrType::kHalf;
  OutputOptions output;
  bool json = false;
};

// "NAME=GAIN" or "NAME=R,G,B".
Result<LightGain> ParseGain(std::string_view flag, std::string_view word) {
  const size_t equals = word.find('=');
  if (equals == 0 || equals == std::string_view::npos)
    return BadInput(fmt::format("{}: \"{}\" is not NAME=GAIN or NAME=R,G,B", flag, word));
  LightGain gain{std::string(word.substr(0, equals))};
  std::vector<float> numbers;
  std::string_view rest = word.substr(equals + 1);
  while (true) {
    const size_t comma = rest.find(',');
    const auto number = ParseNumber(flag, rest.substr(0, comma), 0);
    if (!number) return number.error();
    numbers.push_back(static_cast<float>(*number));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (numbers.size() == 1) numbers.resize(3, numbers[0]);
  if (numbers.size() != 3)
    return BadInput(
        fmt::format("{}: \"{}\" has {} numbers, expected one or three", flag, word, numbers.size()));
  std::ranges::copy(numbers, gain.rgb.begin());
  return gain;
}

void AddRelightFlags(CLI::App& app, RelightOptions& options) {
  AddText(app, "PICTURE", "", "EXR file with light groups (tessera render --light-group)", options.picture,
          Presence::kRequired);
  AddRepeatedWord(
      app, "--gain", "NAME=GAIN",
      "Multiply the light of this group by GAIN, or by one number for each of red, green and blue "
      "(NAME=R,G,B); 0 turns it off",
      kGainsMax, [&options](const std::string& word) -> Result<void> {
        auto gain = ParseGain("--gain", word);
        if (!gain) return gain.error();
        options.gains.push_back(*std::move(gain));
        return {};
      });
  AddValue(app, "--exr-type", "TYPE",
           WithDefault("Type of the colours in the EXR file: half or float", "half"), options.exr_type,
           ParseExrType);
  AddOutputFlags(app, options.output, "none");
  AddJsonFlag(app, options.json);
}

Result<void> CheckRelight(const RelightOptions& options) {
  if (options.output.picture.empty())
    return BadInput("relight: -o FILE is missing: where the picture is written");
  if (options.json && TakesStandardOutput(options.output))
    return BadInput("the standard output cannot take both a picture and the answer of --json");
  return {};
}

Result<int> RunRelight(const RelightOptions& options, Cancellation& cancellation) {
  constexpr int kOnlyFrame = 0;
  const auto start = std::chrono::steady_clock::now();
  PictureNames names(options.output.picture, options.output.png, PictureNames::Numbers::kNone,
                     options.output.no_clobber ? Existing::kKeep : Existing::kReplace);
  names.SetExrOutput(options.output.exr);
  if (auto checked = names.Check({kOnlyFrame}, {options.picture}); !checked) return checked.error();
  const auto picture = LoadExr(options.picture);
  if (!picture) return picture.error();
  if (auto fits = names.CheckSize(picture->width, picture->height); !fits) return fits.error();
  auto mixed = Relight(*picture, options.gains);
  if (!mixed) return BadInput(options.picture + ": " + mixed.error().message);
  SetLightTypes(*mixed, options.exr_type);
  const auto exr = EncodeExr(*mixed, ExrFormat());
  if (!exr) return exr.error();
  auto saved = SavePicture(*exr, kOnlyFrame, names, cancellation.token());
  if (!saved) return saved.error();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) fmt::print("{}\n", PicturesJson({std::move(*saved)}, false, seconds));
  return 0;
}

}  // namespace

Command RelightCommand() {
  return MakeCommand<RelightOptions>({
      .name = "relight",
      .summary = "Mix the light groups of a picture",
      .examples = {{"Double the light of one group and turn another off",
                    "tessera relight picture.exr -o mixed.exr --gain key=2 --gain rim=0"},
                   {"Make the light of the sky warmer",
                    "tessera relight picture.exr -o mixed.exr --gain sky=1,0.8,0.6"}},
      .add_flags = AddRelightFlags,
      .check = CheckRelight,
      .run = RunRelight,
  });
}

}  // namespace tessera
