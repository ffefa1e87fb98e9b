// I4: samples that were acknowledged are never leased again.
#include <map>
#include <tuple>

#include "coordinator/core/schedule/sample_set.h"
#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class RerenderChecker : public Checker {
 public:
  using Checker::Checker;
  void OnAcknowledged(const WorkUnit& unit) override { SamplesOf(unit).Add(unit.range); }
  // All samples of a finished frame are.
  void OnFact(const Fact& fact) override {
    const auto* const finished = std::get_if<FrameFinished>(&fact);
    if (finished == nullptr) return;
    const FrameSpec& spec = world_.ModelOf(finished->job)->spec->frames[finished->frame].spec;
    for (uint32_t tile = 0; tile < static_cast<uint32_t>(spec.TileCount()); ++tile) {
      for (const SampleRange range : DyadicPartition(spec.samples_per_pixel))
        OnAcknowledged({finished->job, finished->frame, tile, range});
    }
  }
  void OnLease(const Farm&, Instant, const Lease& lease) override {
    // Units that are verified are rendered more than once.
    if (world_.options.verify_share == 0 && SamplesOf(lease.unit).Overlaps(lease.unit.range))
      world_.Violation("leased though acknowledged: " + lease.unit.Text());
  }

 private:
  SampleSet& SamplesOf(const WorkUnit& unit) { return acknowledged_[{unit.job, unit.frame, unit.tile}]; }
  std::map<std::tuple<JobId, uint32_t, uint32_t>, SampleSet> acknowledged_;
};

}  // namespace

std::unique_ptr<Checker> MakeRerenderChecker(World& world) {
  return std::make_unique<RerenderChecker>(world);
}

}  // namespace tessera
