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
    const JobModel& job = *world_.ModelOf(finished->job);
    const FrameSpec& spec = job.spec->frames[finished->frame].spec;
    for (uint32_t tile = 0; tile < static_cast<uint32_t>(spec.TileCount()); ++tile) {
      for (const SampleRange range : DyadicPartition(spec.samples_per_pixel))
        OnAcknowledged({finished->job, finished->frame, tile, range, job.scenes[finished->frame]});
    }
  }
  void OnLease(const Farm&, Instant, const Lease& lease) override {
    // Units that are verified are rendered more than once.
    if (world_.options.verify_share == 0 && SamplesOf(lease.unit).Overlaps(lease.unit.range))
      world_.Violation("leased though acknowledged: " + lease.unit.Text());
  }

  void OnRestored() override {
    std::erase_if(acknowledged_, [&](const auto& each) {
      return world_.FrameOf(std::get<Digest>(each.first)).job->directory == world_.directory;
    });
  }

 private:
  SampleSet& SamplesOf(const WorkUnit& unit) { return acknowledged_[{unit.scene, unit.tile}]; }
  std::map<std::tuple<Digest, uint32_t>, SampleSet> acknowledged_;
};

}  // namespace

std::unique_ptr<Checker> MakeRerenderChecker(World& world) {
  return std::make_unique<RerenderChecker>(world);
}

}  // namespace tessera
