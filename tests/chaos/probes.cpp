#include <fmt/format.h>

#include "tests/chaos/faults.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kAnswerPatience{60};  // 5 s are promised; the machine may be loaded

}  // namespace

void Probes::Ask(int farm, std::string why) {
  waiting_.push_back(std::make_unique<Probe>(
      Probe{farm, farms_.CoordinatorFaults(farm), Clock::now() + kAnswerPatience, std::move(why),
            Process(folder_, "tessera",
                    {"workers", "--coordinator", history_.Address(farm), "--patience",
                     std::to_string(kAnswerPatience.count())})}));
}

void Probes::Tick() {
  std::erase_if(waiting_, [&](const std::unique_ptr<Probe>& probe) {
    const auto code = probe->process.Wait(std::chrono::milliseconds(0));
    if (!code && Clock::now() < probe->deadline) return false;
    if (farms_.CoordinatorFaults(probe->farm) != probe->faults) return true;
    ++answered_;
    if (code != 0) {
      problems_.push_back(fmt::format("a client of farm {} was not answered {}: {}", probe->farm, probe->why,
                                      probe->process.Errors()));
    }
    return true;
  });
}

bool Probes::IsWaiting(int farm) const {
  for (const auto& probe : waiting_) {
    if (probe->farm == farm) return true;
  }
  return false;
}

}  // namespace tessera
