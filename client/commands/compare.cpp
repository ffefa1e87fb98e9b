// tessera compare
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "client/output/files_in_use.h"
#include "client/output/output_file.h"
#include "client/output/output_target.h"
#include "client/output/picture_encoder.h"
#include "client/output/picture_format.h"
#include "renderer/compare/difference_picture.h"
#include "renderer/compare/flip.h"
#include "renderer/compare/layer_selection.h"
#include "renderer/compare/picture_difference.h"
#include "renderer/util/cores.h"

namespace tessera {
namespace {

struct CompareOptions {
  std::string a, b;        // paths
  std::string layer;       // compared alone; empty: all channels
  std::string difference;  // path of a PNG; empty: none
  double tolerance = 0;    // largest difference of two values that counts as equal
  bool json = false;
};

void AddCompareFlags(CLI::App& app, CompareOptions& options) {
  AddText(app, "A", "", "EXR file", options.a, Presence::kRequired);
  AddText(app, "B", "", "EXR file of the reference", options.b, Presence::kRequired);
  AddText(app, "--layer", "NAME", "Compare one layer, such as RGB, albedo or Z, instead of all channels",
          options.layer);
  AddText(app, "--difference", "FILE",
          "Write a PNG of the errors of the pixels in false colours: FLIP, or the largest difference if the "
          "layer has no colours",
          options.difference);
  AddValue(app, "--tolerance", "E", WithDefault("Exit with code 0 if no value differs by more than E", "0"),
           options.tolerance,
           [](std::string_view flag, std::string_view word) { return ParseNumber(flag, word, 0); });
  AddJsonFlag(app, options.json);
}

Result<void> CheckCompareOptions(const CompareOptions& options) {
  if (options.difference.empty()) return {};
  const auto format = PictureFormatOf(options.difference);
  if (format && *format == PictureFormat::kPng) return {};
  if (options.difference == kStandardOutput)
    return BadInput("--difference: write to a file; - is taken by the answer");
  return BadInput(fmt::format("--difference: \"{}\" does not end in .png", options.difference));
}

struct Comparison {
  PictureDifference difference;
  std::optional<FlipErrors> flip;  // if both have colours
};

// JSON has no infinity.
nlohmann::ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

void PrintJson(const Comparison& comparison) {
  const PictureDifference& difference = comparison.difference;
  nlohmann::ordered_json json;
  json["mse"] = NumberOrNull(difference.mse);
  json["relmse"] = NumberOrNull(difference.relmse);
  json["psnr"] = NumberOrNull(difference.psnr_db);
  json["maxabs"] = NumberOrNull(difference.maxabs);
  json["identical"] = difference.identical;
  if (comparison.flip) {
    const ExposureRange& exposures = comparison.flip->exposures;
    json["flip"] = comparison.flip->mean;
    json["flip_exposures"] = {
        {"start", exposures.start}, {"stop", exposures.stop}, {"count", exposures.count}};
  }
  fmt::print("{}\n", json.dump());
}

void Print(const CompareOptions& options, const Comparison& comparison) {
  if (options.json) return PrintJson(comparison);
  const PictureDifference& difference = comparison.difference;
  fmt::print("mse={:.6g} relmse={:.6g} psnr={:.6g} maxabs={:.6g} identical={}", difference.mse,
             difference.relmse, difference.psnr_db, difference.maxabs, difference.identical ? "yes" : "no");
  if (comparison.flip) fmt::print(" flip={:.6g}", comparison.flip->mean);
  fmt::print("\n");
}

Result<LoadedPicture> LoadCompared(const CompareOptions& options, const std::string& path) {
  auto picture = LoadExr(path);
  if (!picture || options.layer.empty()) return picture;
  return SelectLayer(*picture, options.layer, path);
}

Result<void> WriteDifference(const std::string& path, const Comparison& comparison, const LoadedPicture& a,
                             const LoadedPicture& b, const std::stop_token& stop) {
  std::vector<float> largest;
  ErrorMap map;
  map.width = a.bounds.width();
  if (comparison.flip) {
    map.errors = comparison.flip->errors;
    map.title = fmt::format("FLIP {:.4f}", comparison.flip->mean);
  } else {
    largest = LargestDifferences(a, b);
    map.errors = largest;
    map.top = TopOf(largest);
    map.title = "MAX |A-B|";
  }
  const BytePicture picture = DrawErrors(map);
  const auto png = EncodePng(picture.width, picture.height, picture.values, path);
  if (!png) return png.error();
  return WriteOutput(path, *png, stop);
}

Result<void> CheckDifferenceFile(const CompareOptions& options) {
  if (options.difference.empty()) return {};
  FilesInUse files;
  files.AddInput(options.a);
  files.AddInput(options.b);
  if (auto ok = files.AddOutput(options.difference); !ok) return ok;
  return CheckEncoder(PictureFormat::kPng);
}

Result<int> RunCompare(const CompareOptions& options, Cancellation& cancellation) {
  if (auto ok = CheckDifferenceFile(options); !ok) return ok.error();
  const auto a = LoadCompared(options, options.a);
  if (!a) return a.error();
  const auto b = LoadCompared(options, options.b);
  if (!b) return b.error();
  const auto difference = Compare(*a, *b);
  if (!difference) return difference.error();
  Comparison comparison{*difference, std::nullopt};
  if (HasColors(*a) && HasColors(*b)) {
    auto flip = HdrFlip(*a, *b, UsableCores(), cancellation.token());
    if (!flip) return flip.error();
    comparison.flip = std::move(*flip);
  }
  if (!options.difference.empty()) {
    auto written = WriteDifference(options.difference, comparison, *a, *b, cancellation.token());
    if (!written) return written.error();
  }
  Print(options, comparison);
  return difference->maxabs <= options.tolerance ? 0 : 1;
}

}  // namespace

Command CompareCommand() {
  return MakeCommand<CompareOptions>({
      .name = "compare",
      .summary = "Compare two pictures",
      .examples = {{"Check that two pictures are identical", "tessera compare a.exr b.exr"},
                   {"Allow small differences", "tessera compare a.exr b.exr --tolerance 0.001"},
                   {"See where two pictures differ", "tessera compare a.exr b.exr --difference errors.png"}},
      .add_flags = AddCompareFlags,
      .check = CheckCompareOptions,
      .run = RunCompare,
  });
}

}  // namespace tessera
