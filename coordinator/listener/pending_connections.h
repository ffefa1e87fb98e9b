// Encrypted connections whose other end has not shown yet that it belongs to the farm. Anybody can make them,
// and each costs a handshake and some memory, so their number is bounded, in total and for each network
// (peer_network.h), and so is the rate at which a network makes them.
//
// A network that reaches a bound loses one of its own connections, chosen at random. So a member that shares
// its address with an attacker gets through after some attempts, and members elsewhere notice nothing.
//
// gRPC owns the connections. This class has a second descriptor of each, with which it ends a connection and
// sees its end, until the peer has identified itself.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <string_view>

#include "coordinator/listener/peer_budget.h"
#include "coordinator/listener/peer_network.h"

namespace tessera {

// An unfinished handshake takes up to some 100 KB. More machines than this hardly connect in the same moment
// from behind one address, and those that lose their place come again.
constexpr size_t kPendingPerNetworkMax = 128;
constexpr size_t kPendingMax = 1024;
// Of the descriptors for connections, where the system grants few: each takes two while it is pending.
constexpr size_t kPendingShare = 8;
// A handshake takes some 0.5 ms. Those of members are given back.
constexpr PeerBudget::Limits kHandshakesPerNetwork{256, 200};

// Thread safe.
class PendingConnections {
 public:
  using TimePoint = PeerBudget::TimePoint;

  PendingConnections();
  ~PendingConnections();
  PendingConnections(const PendingConnections&) = delete;
  PendingConnections& operator=(const PendingConnections&) = delete;

  // A new connection, which stays the caller's. Ends another one if there are too many. Returns false if this
  // one should be closed: its network has made too many, or there is no descriptor for it.
  bool Add(int connection, const sockaddr_storage& peer, TimePoint now);
  // The other end of a connection has shown who it is. `peer` is its address as gRPC writes it.
  void Identified(std::string_view peer);
  // Forgets connections that are closed. `events` is readable if there are some.
  void RemoveClosed();
  int events() const { return events_; }

  size_t size() const { return size_; }
  // How many there may be with the descriptors that this process has.
  static size_t Max();

 private:
  struct Pending {
    int descriptor = -1;
    PeerNetwork network;
    std::string peer;
  };
  using Id = uint64_t;

  bool Watch(int descriptor, Id id) const;
  void Remove(Id id);
  void EndOneOf(const PeerNetwork& network);
  PeerNetwork LargestNetwork();

  int events_ = -1;
  std::atomic<size_t> size_ = 0;

  std::mutex mutex_;
  // Guarded by mutex_.
  std::map<Id, Pending> connections_;
  std::map<std::string, Id, std::less<>> by_peer_;
  std::map<PeerNetwork, std::set<Id>> by_network_;
  PeerBudget handshakes_{kHandshakesPerNetwork};
  Id last_ = 0;
  std::minstd_rand random_;
};

// The address in a text such as "ipv4:10.0.0.1:4711" or "ipv6:%5B2001:db8::1%5D:4711", as PeerText writes it.
// Empty for other texts.
std::string PeerTextOfGrpc(std::string_view peer);

}  // namespace tessera
