#include "proto/shell/system.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <set>

#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

TEST(System, RandomIdsDifferAndAreNotZero) {
  std::set<uint64_t> ids;
  for (int i = 0; i < 100; ++i) ids.insert(RandomId());
  EXPECT_EQ(ids.size(), 100u);
  EXPECT_FALSE(ids.contains(0));
}

TEST(System, ASocketCanBeConnectedToOnlyWhileAProcessListens) {
  const TemporaryDir folder;
  const std::string path = folder / "socket";
  EXPECT_FALSE(CanConnect(path));
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof name.sun_path);
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  EXPECT_FALSE(CanConnect(path));
  ASSERT_EQ(::listen(socket, 1), 0);
  EXPECT_TRUE(CanConnect(path));
  ::close(socket);
  EXPECT_FALSE(CanConnect(path)) << "the file is still there, but nobody listens";
  EXPECT_FALSE(CanConnect(std::string(200, 'x')));
}

}  // namespace
}  // namespace tessera
