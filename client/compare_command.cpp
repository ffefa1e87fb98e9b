// tessera compare: how two pictures differ.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/commands.h"
#include "renderer/film/picture_file.h"

namespace tessera {
namespace {

// JSON has no infinity.
nlohmann::ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

void Print(const Options& options, const PictureDifference& difference) {
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

}  // namespace

Result<int> RunCompare(const Options& options, Cancellation&) {
  const auto a = LoadExr(options.picture_a);
  if (!a) return a.error();
  const auto b = LoadExr(options.picture_b);
  if (!b) return b.error();
  const auto difference = Compare(*a, *b);
  if (!difference) return difference.error();
  Print(options, *difference);
  return difference->maxabs <= options.tolerance ? 0 : 1;
}

}  // namespace tessera
