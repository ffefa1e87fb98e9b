// What may be leased: nothing of a paused job, and nothing that one machine alone would not have rendered
// because the tile or its pixels stop before.
#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class LeaseChecker : public Checker {
 public:
  using Checker::Checker;
  void OnLease(const Farm& farm, Instant now, const Lease& lease) override {
    const WorkUnit& unit = lease.unit;
    const auto status = farm.Status(now, unit.job);
    if (status && status->paused_by_user)
      world_.Violation("a unit of a paused job is leased: " + unit.Text());
    // By its submission: the job may not be journalled yet.
    const JobModel& job = world_.jobs[farm.Spec(unit.job)->submission - 1];
    const Merger& reference = job.reference[unit.frame];
    if (unit.range.end() > reference.Goal(static_cast<int>(unit.tile)).samples)
      world_.Violation("leased though its tile stops before: " + unit.Text());
    if (reference.spec().IsAdaptive() && !HasRightPixels(job.pictures[unit.frame], lease))
      world_.Violation("leased with other pixels than are wanted: " + unit.Text());
  }

 private:
  static bool HasRightPixels(const FramePicture& picture, const Lease& lease) {
    const std::vector<float> samples = picture.Channel(kSamplesChannel);
    size_t pixel = 0;
    for (int y = lease.bounds.y0; y < lease.bounds.y1; ++y) {
      for (int x = lease.bounds.x0; x < lease.bounds.x1; ++x, ++pixel) {
        const float count = samples[static_cast<size_t>(y * picture.bounds.width() + x)];
        if (lease.pixels.Has(pixel) != (count >= static_cast<float>(lease.unit.range.end()))) return false;
      }
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<Checker> MakeLeaseChecker(World& world) {
  return std::make_unique<LeaseChecker>(world);
}

}  // namespace tessera
