// The tests of several machines: each machine is a network namespace.
#include <gtest/gtest.h>

#include "tests/hosts/network.h"

int main(int argc, char** argv) {
  tessera::BecomeRootOfUserNamespace();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
