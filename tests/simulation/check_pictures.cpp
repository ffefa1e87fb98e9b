// I2 and I3: whatever came in whatever order, the picture is that of one machine to the last bit.
#include "tests/simulation/checker.h"

namespace tessera {
namespace {

class PictureChecker : public Checker {
 public:
  using Checker::Checker;
  void OnPicture(const FinishedPicture& finished) override {
    const FramePicture& expected = world_.ModelOf(finished.job)->pictures[finished.frame];
    const FramePicture picture = finished.snapshot.Picture();
    if (picture.values != expected.values) world_.Violation("a picture differs from the reference");
  }
};

}  // namespace

std::unique_ptr<Checker> MakePictureChecker(World& world) {
  return std::make_unique<PictureChecker>(world);
}

}  // namespace tessera
