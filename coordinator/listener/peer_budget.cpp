#include "coordinator/listener/peer_budget.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::chrono::seconds kForgetInterval{1};

}  // namespace

double PeerBudget::AttemptsAt(const Budget& budget, TimePoint now) const {
  const double seconds = std::chrono::duration<double>(now - budget.at).count();
  return std::min(limits_.attempts_max, budget.attempts + seconds * limits_.attempts_per_second);
}

// A peer that has all attempts again is the same as an unknown one.
void PeerBudget::Forget(TimePoint now) {
  forgotten_ = now;
  std::erase_if(budgets_,
                [&](const auto& each) { return AttemptsAt(each.second, now) >= limits_.attempts_max; });
}

bool PeerBudget::Take(const PeerNetwork& peer, TimePoint now) {
  if (now - forgotten_ >= kForgetInterval) Forget(now);
  const bool is_known = budgets_.contains(peer) || budgets_.size() < limits_.peers_max;
  // The address of all zeros is that of nobody.
  const auto [found, is_new] = budgets_.try_emplace(is_known ? peer : PeerNetwork{});
  Budget& budget = found->second;
  budget = {is_new ? limits_.attempts_max : AttemptsAt(budget, now), now};
  if (budget.attempts < 1) return false;
  budget.attempts -= 1;
  return true;
}

void PeerBudget::GiveBack(const PeerNetwork& peer) {
  const auto found = budgets_.find(peer);
  if (found != budgets_.end())
    found->second.attempts = std::min(limits_.attempts_max, found->second.attempts + 1);
}

}  // namespace tessera
