#include "client/commands/print_forecast.h"

#include <fmt/format.h>

#include "client/dry_run.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kForecastProbe{2000};  // a few per cent of what is worth an estimate

}  // namespace

Result<int> PrintForecast(const SceneOptions& options, int threads, bool json, Cancellation& cancellation) {
  const auto forecast = MakeForecast(options, threads, kForecastProbe, cancellation);
  if (!forecast) return forecast.error();
  fmt::print("{}", json ? ForecastJson(*forecast) : ForecastText(*forecast));
  return 0;
}

}  // namespace tessera
