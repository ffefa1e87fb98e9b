#include "tests/chaos/chaos_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSmallDiskOptions = "size=24m";  // less than the pictures and spools of all jobs

// Makes the mounts of this process private to it and its children. Without permission to mount, becomes root
// in a namespace if the system allows it.
bool MakeMountsPrivate() {
  const uid_t user = ::getuid();
  const gid_t group = ::getgid();
  if (::unshare(CLONE_NEWNS) != 0) {
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << fmt::format("0 {} 1", user);
    std::ofstream("/proc/self/gid_map") << fmt::format("0 {} 1", group);
  }
  return ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

}  // namespace

ChaosFolder::ChaosFolder(bool small_disk) {
  std::string path = "/tmp/tessera-chaos-XXXXXX";
  if (::mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot create a folder in /tmp");
  path_ = path;
  fs::create_directories(path_ + "/tmp");
  fs::create_directories(disk());
  if (!small_disk) return;
  is_mounted_ =
      MakeMountsPrivate() && ::mount("tessera-chaos", disk().c_str(), "tmpfs", 0, kSmallDiskOptions) == 0;
  if (!is_mounted_) mount_error_ = std::strerror(errno);
}

ChaosFolder::~ChaosFolder() {
  if (is_mounted_) ::umount2(disk().c_str(), MNT_DETACH);
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void DiskFiller::Fill(Clock::duration duration) {
  until_ = Clock::now() + duration;
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const std::string block(size_t{1} << 16, 'x');
  for (size_t size = block.size(); size > 0;) {  // smaller blocks for the remaining space
    if (::write(file, block.data(), size) <= 0) size /= 2;
  }
  ::close(file);
}

void DiskFiller::Tick() {
  if (is_full() && Clock::now() >= until_) End();
}

void DiskFiller::End() {
  std::error_code ignored;
  fs::remove(path_, ignored);
  until_ = {};
}

}  // namespace tessera
