// Hosts with addresses of their own, in network namespaces, and a network between them that lives in this
// process: each host has a TUN device, and a thread here carries the packets, with delay, loss, a limited
// rate or not at all. Nothing of it is visible to the machine, and all of it ends with the process.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace tessera {

// Lets a user who is not root make networks, if the system allows that. Call it before threads start.
void BecomeRootOfUserNamespace();
// Why this machine cannot have such a network; empty if it can.
std::string WhyNoNetwork();

// Of what every host sends.
struct LinkTerms {
  std::chrono::milliseconds latency{0};
  double loss = 0;        // share of the packets
  double bits_per_s = 0;  // 0: not limited
};

class Network {
 public:
  // Throws std::system_error if the system does not allow it.
  explicit Network(int hosts);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  static std::string Address(int host);
  // The words that run a program on a host, to be followed by the program and its arguments.
  std::vector<std::string> Enter(int host) const;

  void SetTerms(const LinkTerms& terms);
  // Whether packets of one host for another vanish.
  void Block(int from, int to, bool is_blocked);
  // Packets from and to the host vanish from now on, as when its cable is pulled.
  void CutOff(int host);
  // Bytes of the packets that have arrived.
  uint64_t bytes_carried() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Host {
    int space = -1;                   // its network namespace
    int device = -1;                  // its packets
    Clock::time_point sends_until{};  // when its link has sent everything before
  };
  struct Packet {
    int to = 0;
    std::string bytes;
  };

  static Host MakeHost(int index);
  void Carry();
  void ReceiveFrom(int host);
  void Send(int from, std::string bytes);
  void Deliver(Clock::time_point now);
  int TimeToWait_ms() const;

  std::vector<Host> hosts_;
  int stop_event_ = -1;
  mutable std::mutex mutex_;  // of what follows
  LinkTerms terms_;
  std::set<std::pair<int, int>> blocked_;
  std::multimap<Clock::time_point, Packet> under_way_;  // by the time of arrival
  std::mt19937 random_{1};
  uint64_t bytes_carried_ = 0;
  std::thread thread_;  // last: it uses the others
};

}  // namespace tessera
