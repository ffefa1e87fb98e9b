// Verification trusts the right workers: no sound worker is ever put into quarantine.
#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class VerificationChecker : public Checker {
 public:
  using Checker::Checker;
  void OnFact(const Fact& fact) override {
    const auto* const block = std::get_if<WorkerQuarantined>(&fact);
    if (block == nullptr || block->quarantine.empty()) return;
    if (!world_.faulty_workers.contains(block->worker))
      world_.Violation("a sound worker is in quarantine: " + block->quarantine);
  }
};

}  // namespace

std::unique_ptr<Checker> MakeVerificationChecker(World& world) {
  return std::make_unique<VerificationChecker>(world);
}

}  // namespace tessera
