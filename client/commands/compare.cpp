// tessera compare
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/commands/commands.h"
#include "client/commands/option_groups.h"
#include "client/commands/option_values.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

struct CompareOptions {
  std::string a, b;      // paths
  double tolerance = 0;  // largest difference of two values that counts as equal
  bool json = false;
};

void AddCompareFlags(CLI::App& app, CompareOptions& options) {
  AddText(app, "A", "", "EXR file", options.a, Presence::kRequired);
  AddText(app, "B", "", "EXR file of the reference", options.b, Presence::kRequired);
  AddValue(app, "--tolerance", "E", WithDefault("Exit with code 0 if no value differs by more than E", "0"),
           options.tolerance,
           [](std::string_view flag, std::string_view word) { return ParseNumber(flag, word, 0); });
  AddJsonFlag(app, options.json);
}

// JSON has no infinity.
nlohmann::ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

void Print(const CompareOptions& options, const PictureDifference& difference) {
  if (!options.json) {
    fmt::print("mse={:.6g} relmse={:.6g} psnr={:.6g} maxabs={:.6g} identical={}\n", difference.mse,
               difference.relmse, difference.psnr_db, difference.maxabs, difference.identical ? "yes" : "no");
    return;
  }
  nlohmann::ordered_json json;
  json["mse"] = NumberOrNull(difference.mse);
  json["relmse"] = NumberOrNull(difference.relmse);
  json["psnr"] = NumberOrNull(difference.psnr_db);
  json["maxabs"] = NumberOrNull(difference.maxabs);
  json["identical"] = difference.identical;
  fmt::print("{}\n", json.dump());
}

Result<int> RunCompare(const CompareOptions& options, Cancellation&) {
  const auto a = LoadExr(options.a);
  if (!a) return a.error();
  const auto b = LoadExr(options.b);
  if (!b) return b.error();
  const auto difference = Compare(*a, *b);
  if (!difference) return difference.error();
  Print(options, *difference);
  return difference->maxabs <= options.tolerance ? 0 : 1;
}

}  // namespace

Command CompareCommand() {
  return MakeCommand<CompareOptions>({
      .name = "compare",
      .summary = "Compare two pictures",
      .examples = {{"Check that two pictures are identical", "tessera compare a.exr b.exr"},
                   {"Allow small differences", "tessera compare a.exr b.exr --tolerance 0.001"}},
      .add_flags = AddCompareFlags,
      .run = RunCompare,
  });
}

}  // namespace tessera
