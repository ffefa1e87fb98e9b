#include "coordinator/listener/pending_connections.h"

#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "coordinator/listener/descriptors.h"
#include "proto/shell/system.h"

namespace tessera {
namespace {

constexpr size_t kEventsMax = 64;

// Replaces %5B and the like in addresses of IPv6.
std::string WithoutEscapes(std::string_view text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    const std::string_view escape = text.substr(i, 3);
    if (escape == "%5B" || escape == "%5D" || escape == "%25") {
      plain += escape == "%5B" ? '[' : escape == "%5D" ? ']' : '%';
      i += 2;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

}  // namespace

std::string PeerTextOfGrpc(std::string_view peer) {
  if (peer.starts_with("ipv4:")) return std::string(peer.substr(5));
  if (!peer.starts_with("ipv6:")) return {};
  std::string text = WithoutEscapes(peer.substr(5));
  // The interface of a link-local address.
  const size_t scope = text.find('%'), end = text.find(']');
  if (scope < end && end != std::string::npos) text.erase(scope, end - scope);
  return text;
}

PendingConnections::PendingConnections()
    : events_(::epoll_create1(EPOLL_CLOEXEC)),
      random_(static_cast<std::minstd_rand::result_type>(RandomId())) {}

PendingConnections::~PendingConnections() {
  for (const auto& [id, each] : connections_) ::close(each.descriptor);
  if (events_ >= 0) ::close(events_);
}

// Reports when both directions are closed, which is what gRPC does with a connection that it gives up.
bool PendingConnections::Watch(int descriptor, Id id) const {
  epoll_event event{};
  event.data.u64 = id;
  return ::epoll_ctl(events_, EPOLL_CTL_ADD, descriptor, &event) == 0;
}

bool PendingConnections::Add(int connection, const sockaddr_storage& peer, TimePoint now) {
  const PeerNetwork network = NetworkOf(peer);
  const std::lock_guard lock(mutex_);
  if (!handshakes_.Take(network, now)) return false;
  if (by_network_.contains(network) && by_network_[network].size() >= kPendingPerNetworkMax) {
    EndOneOf(network);
  } else if (connections_.size() >= Max()) {
    EndOneOf(LargestNetwork());
  }
  const int descriptor = ::fcntl(connection, F_DUPFD_CLOEXEC, 0);
  const Id id = ++last_;
  if (descriptor < 0 || !Watch(descriptor, id)) {
    if (descriptor >= 0) ::close(descriptor);
    return false;
  }
  // A connection of the same address that was closed without notice is not that of this peer.
  std::string text = PeerText(peer);
  if (const auto former = by_peer_.find(text); former != by_peer_.end()) Remove(former->second);
  by_peer_[text] = id;
  by_network_[network].insert(id);
  connections_[id] = {descriptor, network, std::move(text)};
  size_ = connections_.size();
  return true;
}

// The registration goes first: it belongs to the connection, which may stay open.
void PendingConnections::Remove(Id id) {
  const auto found = connections_.find(id);
  if (found == connections_.end()) return;
  const Pending& pending = found->second;
  ::epoll_ctl(events_, EPOLL_CTL_DEL, pending.descriptor, nullptr);
  ::close(pending.descriptor);
  by_peer_.erase(pending.peer);
  const auto network = by_network_.find(pending.network);
  network->second.erase(id);
  if (network->second.empty()) by_network_.erase(network);
  connections_.erase(found);
  size_ = connections_.size();
}

size_t PendingConnections::Max() {
  const size_t share = static_cast<size_t>(ConnectionDescriptorsMax()) / kPendingShare;
  return std::clamp<size_t>(share, 1, kPendingMax);
}

// Any of them if several are the largest.
PeerNetwork PendingConnections::LargestNetwork() {
  std::vector<PeerNetwork> largest;
  size_t count = 0;
  for (const auto& [network, ids] : by_network_) {
    if (ids.size() > count) largest.clear();
    count = std::max(count, ids.size());
    if (ids.size() == count) largest.push_back(network);
  }
  return largest[std::uniform_int_distribution<size_t>(0, largest.size() - 1)(random_)];
}

// gRPC finds the connection closed and forgets it.
void PendingConnections::EndOneOf(const PeerNetwork& network) {
  const std::set<Id>& candidates = by_network_.at(network);
  std::uniform_int_distribution<size_t> place(0, candidates.size() - 1);
  const Id id = *std::next(candidates.begin(), static_cast<std::ptrdiff_t>(place(random_)));
  ::shutdown(connections_.at(id).descriptor, SHUT_RDWR);
  Remove(id);
}

void PendingConnections::Identified(std::string_view peer) {
  if (size_ == 0) return;  // as in most calls
  const std::string text = PeerTextOfGrpc(peer);
  const std::lock_guard lock(mutex_);
  const auto found = by_peer_.find(text);
  if (found == by_peer_.end()) return;
  const Id id = found->second;
  handshakes_.GiveBack(connections_.at(id).network);
  Remove(id);
}

void PendingConnections::RemoveClosed() {
  std::array<epoll_event, kEventsMax> events{};
  const std::lock_guard lock(mutex_);
  while (true) {
    const int count = ::epoll_wait(events_, events.data(), static_cast<int>(events.size()), 0);
    for (int i = 0; i < count; ++i) Remove(events[static_cast<size_t>(i)].data.u64);
    if (count < static_cast<int>(events.size())) return;
  }
}

}  // namespace tessera
