#include "worker/machine_id.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tessera {
namespace {

TEST(MachineId, IsTheSameInAllProcessesOfAMachine) {
  const uint64_t id = MachineId();
  EXPECT_NE(id, 0u);
  const pid_t other = ::fork();
  if (other == 0) ::_exit(MachineId() == id ? 0 : 1);
  int status = -1;
  ASSERT_EQ(::waitpid(other, &status, 0), other);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace tessera
