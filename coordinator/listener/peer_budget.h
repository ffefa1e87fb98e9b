// How often peers may do something that costs us more than them: each has a number of attempts, which come
// back with time. Pure: times come in as arguments. Not thread safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>

#include "coordinator/listener/peer_network.h"

namespace tessera {

class PeerBudget {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  struct Limits {
    double attempts_max = 0;
    double attempts_per_second = 0;
    // Peers that are known at the same time. Those beyond share one budget, so that a crowd of addresses
    // takes no more memory.
    size_t peers_max = 10'000;
  };
  explicit PeerBudget(const Limits& limits) : limits_(limits) {}

  // Uses up an attempt. Returns false if the peer has none.
  bool Take(const PeerNetwork& peer, TimePoint now);
  // Returns an attempt: it was a good one.
  void GiveBack(const PeerNetwork& peer);
  // Peers that have used up something.
  size_t size() const { return budgets_.size(); }

 private:
  struct Budget {
    double attempts = 0;
    TimePoint at{};
  };
  double AttemptsAt(const Budget& budget, TimePoint now) const;
  void Forget(TimePoint now);

  const Limits limits_;
  std::map<PeerNetwork, Budget> budgets_;  // peers without an entry have all attempts
  TimePoint forgotten_{};
};

}  // namespace tessera
