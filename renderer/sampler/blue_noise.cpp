#include "renderer/sampler/blue_noise.h"

#include <cstdint>
#include <vector>

#include "renderer/util/hash.h"

namespace tessera {

// Orders the places of the mask so that those up to any rank are spread evenly.
class VoidAndCluster {
 public:
  static BlueNoise Make() {
    VoidAndCluster work;
    work.Scatter();
    work.Even();
    work.Rank();
    return work.noise_;
  }

 private:
  static constexpr int kSide = kBlueNoiseSide, kPlaces = kSide * kSide;
  static constexpr int kFirst = kPlaces / 10;  // places of the pattern from which the others are ranked
  static constexpr int kReach = 9;             // pixels: farther away the influence of a place is nothing
  // Influence falls with exp(-r^2 / (2 sigma^2)), sigma = 1.5 pixels, in units of 2^-30.
  static constexpr int64_t kUnit = int64_t{1} << 30;
  static constexpr int64_t kFall = 859785240;  // exp(-1 / (2 * 1.5^2)) * 2^30

  VoidAndCluster() : influence_(2 * kReach * kReach + 1, kUnit) {
    for (size_t i = 1; i < influence_.size(); ++i) influence_[i] = influence_[i - 1] * kFall / kUnit;
  }

  void Set(int place, bool taken) {
    taken_[place] = taken;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int y = (place / kSide + dy + kSide) % kSide, x = (place % kSide + dx + kSide) % kSide;
        const int squared = dx * dx + dy * dy;
        const int64_t influence = influence_[static_cast<size_t>(squared)];
        crowding_[y * kSide + x] += taken ? influence : -influence;
      }
    }
  }

  // The most crowded of the places that are taken, or the least crowded of the free ones; the first of
  // equals.
  int Extreme(bool taken) const {
    int best = -1;
    for (int i = 0; i < kPlaces; ++i) {
      if (taken_[i] != taken) continue;
      if (best < 0 || (taken ? crowding_[i] > crowding_[best] : crowding_[i] < crowding_[best])) best = i;
    }
    return best;
  }

  void Scatter() {
    int count = 0;
    for (uint64_t i = 0; count < kFirst; ++i) {
      const int place = static_cast<int>(Hash(i) % kPlaces);
      if (taken_[place]) continue;
      Set(place, true);
      ++count;
    }
  }

  // Moves crowded places into the largest gaps until none moves.
  void Even() {
    for (int moves = 0; moves < kPlaces; ++moves) {
      const int cluster = Extreme(true);
      Set(cluster, false);
      const int gap = Extreme(false);
      Set(gap, true);
      if (gap == cluster) return;
    }
  }

  void Rank() {
    const VoidAndCluster pattern = *this;
    for (int rank = kFirst - 1; rank >= 0; --rank) {
      const int place = Extreme(true);
      Set(place, false);
      Give(place, rank);
    }
    const BlueNoise ranked = noise_;
    *this = pattern;
    noise_ = ranked;
    for (int rank = kFirst; rank < kPlaces; ++rank) {
      const int place = Extreme(false);
      Set(place, true);
      Give(place, rank);
    }
  }

  void Give(int place, int rank) {
    noise_.values_[static_cast<size_t>(place)] = static_cast<float>(rank) / kPlaces;
  }

  std::vector<int64_t> influence_;  // by the square of the distance
  std::array<bool, kPlaces> taken_{};
  std::array<int64_t, kPlaces> crowding_{};  // the influence of all places that are taken
  BlueNoise noise_;
};

const BlueNoise& BlueNoise::Get() {
  static const BlueNoise noise = VoidAndCluster::Make();
  return noise;
}

}  // namespace tessera
