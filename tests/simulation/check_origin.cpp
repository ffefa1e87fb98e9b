// I6: a result enters only the picture that it was rendered for, whatever happens to data directories and
// addresses.
#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class OriginChecker : public Checker {
 public:
  using Checker::Checker;
  void OnAcknowledged(const WorkUnit& unit) override {
    const JobModel* const job = world_.ModelOf(unit.job);
    if (job == nullptr || unit.frame >= job->scenes.size() || job->scenes[unit.frame] != unit.scene)
      world_.Violation("a result of another picture is accepted: " + unit.Text());
  }
};

}  // namespace

std::unique_ptr<Checker> MakeOriginChecker(World& world) {
  return std::make_unique<OriginChecker>(world);
}

}  // namespace tessera
