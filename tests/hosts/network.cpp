#include "tests/hosts/network.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <exception>
#include <fstream>
#include <system_error>

namespace tessera {
namespace {

constexpr const char* kNsenter = "/usr/bin/nsenter";  // of util-linux, which every Debian has
constexpr size_t kPacketBytesMax = 65'536;
// What waits for a link of limited rate; more is dropped, as by a router.
constexpr std::chrono::milliseconds kQueueMax{200};
// Of an IPv4 packet: where the last byte of the destination is.
constexpr size_t kHeaderBytes = 20, kLastOfDestination = 19;
constexpr unsigned char kVersion4 = 4;

void Require(bool succeeded, const char* what) {
  if (!succeeded) throw std::system_error(errno, std::generic_category(), what);
}

// A socket through which interfaces of the namespace of this thread are set up.
class Interfaces {
 public:
  Interfaces() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) { Require(fd_ >= 0, "socket"); }
  ~Interfaces() { ::close(fd_); }
  Interfaces(const Interfaces&) = delete;
  Interfaces& operator=(const Interfaces&) = delete;

  void SetAddress(const char* interface, const std::string& address, const char* mask) const {
    Apply(SIOCSIFADDR, Request(interface, address.c_str()), "SIOCSIFADDR");
    Apply(SIOCSIFNETMASK, Request(interface, mask), "SIOCSIFNETMASK");
  }
  void BringUp(const char* interface) const {
    ifreq request = Request(interface, nullptr);
    request.ifr_flags = IFF_UP | IFF_RUNNING;
    Apply(SIOCSIFFLAGS, request, "SIOCSIFFLAGS");
  }

 private:
  static ifreq Request(const char* interface, const char* address) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
    if (address != nullptr) {
      auto& name = reinterpret_cast<sockaddr_in&>(request.ifr_addr);
      name.sin_family = AF_INET;
      Require(::inet_pton(AF_INET, address, &name.sin_addr) == 1, "inet_pton");
    }
    return request;
  }
  void Apply(unsigned long what, ifreq request, const char* name) const {
    Require(::ioctl(fd_, what, &request) == 0, name);
  }

  int fd_;
};

int OpenTunDevice(const char* name) {
  const int device = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  Require(device >= 0, "/dev/net/tun");
  ifreq request{};
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  std::strncpy(request.ifr_name, name, IFNAMSIZ - 1);
  Require(::ioctl(device, TUNSETIFF, &request) == 0, "TUNSETIFF");
  return device;
}

void WriteTo(const char* path, const std::string& text) {
  std::ofstream file(path);
  file << text;
}

}  // namespace

void BecomeRootOfUserNamespace() {
  const uid_t user = ::geteuid();
  const gid_t group = ::getegid();
  if (user == 0 || ::unshare(CLONE_NEWUSER) != 0) return;
  WriteTo("/proc/self/setgroups", "deny");
  WriteTo("/proc/self/uid_map", "0 " + std::to_string(user) + " 1");
  WriteTo("/proc/self/gid_map", "0 " + std::to_string(group) + " 1");
}

std::string WhyNoNetwork() {
  if (::access(kNsenter, X_OK) != 0) return std::string(kNsenter) + " is missing";
  try {
    const Network network(1);
    return {};
  } catch (const std::system_error& error) {
    return std::string("network namespaces cannot be used: ") + error.what();
  }
}

Network::Network(int hosts) {
  for (int i = 0; i < hosts; ++i) hosts_.push_back(MakeHost(i));
  stop_event_ = ::eventfd(0, EFD_CLOEXEC);
  Require(stop_event_ >= 0, "eventfd");
  thread_ = std::thread([this] { Carry(); });
}

Network::~Network() {
  const uint64_t one = 1;
  if (::write(stop_event_, &one, sizeof one) == sizeof one) thread_.join();
  for (const Host& each : hosts_) {
    ::close(each.device);
    ::close(each.space);
  }
  ::close(stop_event_);
}

std::string Network::Address(int host) {
  return "10.77.0." + std::to_string(host + 1);
}

// A thread may be in another namespace than its process.
Network::Host Network::MakeHost(int index) {
  Host host;
  std::exception_ptr failure;
  std::thread([&] {
    try {
      Require(::unshare(CLONE_NEWNET) == 0, "unshare");
      host.space = ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
      Require(host.space >= 0, "/proc/thread-self/ns/net");
      host.device = OpenTunDevice("eth0");
      const Interfaces interfaces;
      interfaces.BringUp("lo");
      interfaces.SetAddress("eth0", Address(index), "255.255.255.0");
      interfaces.BringUp("eth0");
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) std::rethrow_exception(failure);
  return host;
}

std::vector<std::string> Network::Enter(int host) const {
  const std::string space = "/proc/" + std::to_string(::getpid()) + "/fd/" +
                            std::to_string(hosts_.at(static_cast<size_t>(host)).space);
  return {kNsenter, "--net=" + space, "--"};
}

void Network::SetTerms(const LinkTerms& terms) {
  const std::lock_guard lock(mutex_);
  terms_ = terms;
}

void Network::Block(int from, int to, bool is_blocked) {
  const std::lock_guard lock(mutex_);
  if (is_blocked) {
    blocked_.insert({from, to});
  } else {
    blocked_.erase({from, to});
  }
}

void Network::CutOff(int host) {
  for (int other = 0; other < static_cast<int>(hosts_.size()); ++other) {
    Block(host, other, true);
    Block(other, host, true);
  }
}

uint64_t Network::bytes_carried() const {
  const std::lock_guard lock(mutex_);
  return bytes_carried_;
}

void Network::Carry() {
  std::vector<pollfd> events;
  for (const Host& each : hosts_) events.push_back({each.device, POLLIN, 0});
  events.push_back({stop_event_, POLLIN, 0});
  while (true) {
    ::poll(events.data(), events.size(), TimeToWait_ms());
    if (events.back().revents != 0) return;
    const std::lock_guard lock(mutex_);
    for (size_t i = 0; i + 1 < events.size(); ++i) {
      if (events[i].revents != 0) ReceiveFrom(static_cast<int>(i));
    }
    Deliver(Clock::now());
  }
}

int Network::TimeToWait_ms() const {
  const std::lock_guard lock(mutex_);
  if (under_way_.empty()) return -1;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(under_way_.begin()->first - Clock::now());
  return left.count() > 0 ? static_cast<int>(left.count()) : 0;
}

void Network::ReceiveFrom(int host) {
  constexpr int kPacketsAtOnce = 64;  // then others have their turn
  std::string bytes(kPacketBytesMax, '\0');
  for (int i = 0; i < kPacketsAtOnce; ++i) {
    const ssize_t count = ::read(hosts_[static_cast<size_t>(host)].device, bytes.data(), bytes.size());
    if (count <= 0) return;
    Send(host, bytes.substr(0, static_cast<size_t>(count)));
  }
}

void Network::Send(int from, std::string bytes) {
  if (bytes.size() < kHeaderBytes || static_cast<unsigned char>(bytes[0]) >> 4 != kVersion4) return;
  const int to = static_cast<unsigned char>(bytes[kLastOfDestination]) - 1;
  if (to < 0 || to >= static_cast<int>(hosts_.size()) || blocked_.contains({from, to})) return;
  if (std::uniform_real_distribution<>()(random_) < terms_.loss) return;
  auto arrival = Clock::now();
  if (terms_.bits_per_s > 0) {
    Clock::time_point& sends_until = hosts_[static_cast<size_t>(from)].sends_until;
    if (sends_until > arrival + kQueueMax) return;
    const std::chrono::duration<double> takes(static_cast<double>(bytes.size()) * 8 / terms_.bits_per_s);
    sends_until = std::max(sends_until, arrival) + std::chrono::duration_cast<Clock::duration>(takes);
    arrival = sends_until;
  }
  under_way_.emplace(arrival + terms_.latency, Packet{to, std::move(bytes)});
}

void Network::Deliver(Clock::time_point now) {
  while (!under_way_.empty() && under_way_.begin()->first <= now) {
    const Packet& packet = under_way_.begin()->second;
    const int device = hosts_[static_cast<size_t>(packet.to)].device;
    if (::write(device, packet.bytes.data(), packet.bytes.size()) > 0) bytes_carried_ += packet.bytes.size();
    under_way_.erase(under_way_.begin());
  }
}

}  // namespace tessera
