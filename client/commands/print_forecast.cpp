#include "client/commands/print_forecast.h"

#include <fmt/format.h>

#include "client/dry_run.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds kForecastProbe{2000};  // a few per cent of what is worth an estimate

}  // namespace

Result<int> PrintForecast(const SceneOptions& options, int threads, bool json, Cancellation& cancellation,
                          const std::optional<FarmCapacity>& farm) {
  auto forecast = MakeForecast(options, threads, kForecastProbe, cancellation);
  if (!forecast) return forecast.error();
  forecast->farm = farm;
  fmt::print("{}", json ? ForecastJson(*forecast) : ForecastText(*forecast));
  return 0;
}

}  // namespace tessera
