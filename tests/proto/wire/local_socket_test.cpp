#include "proto/wire/local_socket.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <future>

#include "tests/coordinator/store/temporary_dir.h"

namespace tessera {
namespace {

// A socket that is bound to the path; it listens if `listens`.
int BindSocket(const std::string& path, bool listens) {
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  if (listens) {
    EXPECT_EQ(::listen(socket, 1), 0);
  }
  return socket;
}

TEST(LocalSocketFiles, OnlySocketsOnWhichNobodyListensAreRemoved) {
  const TemporaryDir folder;
  for (const char* name : {"a.socket", "b.socket"}) ::close(BindSocket(folder / name, true));
  ::close(BindSocket(folder / "other-program", true));
  const int open = BindSocket(folder / "open.socket", true);
  std::ofstream(folder / "file.socket") << "no socket";
  std::filesystem::create_symlink(folder / "other-program", folder / "link.socket");
  EXPECT_EQ(RemoveStaleSockets(folder / ""), 2);
  for (const char* name : {"a.socket", "b.socket"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  for (const char* name : {"other-program", "open.socket", "file.socket", "link.socket"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  EXPECT_EQ(RemoveStaleSockets(folder / ""), 0);
  ::close(open);
}

TEST(LocalSocketFiles, ABusyListenerIsNotDeserted) {
  const TemporaryDir folder;
  const int open = BindSocket(folder / "busy.socket", true);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(RemoveStaleSockets(folder / ""), 0);  // more than its backlog
  EXPECT_TRUE(std::filesystem::exists(folder / "busy.socket"));
  ::close(open);
}

TEST(LocalSocketFiles, AMissingFolderHasNone) {
  const TemporaryDir folder;
  const SocketFolderLock lock(folder / "missing");
  EXPECT_EQ(RemoveStaleSockets(folder / "missing"), 0);
}

TEST(LocalSocketFiles, TheLockKeepsOthersOut) {
  const TemporaryDir folder;
  std::future<void> other;
  {
    const SocketFolderLock lock(folder / "");
    other = std::async(std::launch::async, [&] { const SocketFolderLock second(folder / ""); });
    EXPECT_EQ(other.wait_for(std::chrono::milliseconds(100)), std::future_status::timeout);
  }
  other.get();
}

}  // namespace
}  // namespace tessera
