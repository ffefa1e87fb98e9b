#include "tests/simulation/checker.h"

namespace tessera {

std::vector<std::unique_ptr<Checker>> MakeCheckers(World& world) {
  std::vector<std::unique_ptr<Checker>> checkers;
  for (const auto make : {MakePictureChecker, MakeOriginChecker, MakeMemoryChecker, MakeRerenderChecker,
                          MakeLeaseChecker, MakeVerificationChecker, MakeEndChecker}) {
    checkers.push_back(make(world));
  }
  return checkers;
}

}  // namespace tessera
