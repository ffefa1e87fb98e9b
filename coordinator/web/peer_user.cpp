#include "coordinator/web/peer_user.h"

#include <linux/inet_diag.h>
#include <linux/netlink.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstring>

namespace tessera {
namespace {

struct DiagRequest {
  nlmsghdr head{};
  inet_diag_req_v2 body{};
};

// Sets one end of the connection that is asked about.
bool SetEnd(const sockaddr_storage& name, uint8_t& family, __be16& port, __be32 (&address)[4]) {
  family = static_cast<uint8_t>(name.ss_family);
  if (name.ss_family == AF_INET) {
    const auto& ipv4 = reinterpret_cast<const sockaddr_in&>(name);
    port = ipv4.sin_port;
    address[0] = ipv4.sin_addr.s_addr;
    return true;
  }
  if (name.ss_family != AF_INET6) return false;
  const auto& ipv6 = reinterpret_cast<const sockaddr_in6&>(name);
  port = ipv6.sin6_port;
  // The other end of a mapped address is a socket of IPv4.
  if (IN6_IS_ADDR_V4MAPPED(&ipv6.sin6_addr)) {
    family = AF_INET;
    std::memcpy(address, &ipv6.sin6_addr.s6_addr[12], 4);
  } else {
    std::memcpy(address, &ipv6.sin6_addr, 16);
  }
  return true;
}

// Stands for users that this process cannot name (user_namespaces(7)).
constexpr uid_t kOverflowUser = 65534;

// The user of the socket that the request names, as the kernel answers.
bool AskUser(const DiagRequest& request, uid_t& user) {
  const int kernel = ::socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC, NETLINK_SOCK_DIAG);
  if (kernel < 0) return false;
  const timeval patience{1, 0};
  ::setsockopt(kernel, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  alignas(nlmsghdr) char answer[4096];
  ssize_t size = -1;
  if (::send(kernel, &request, sizeof request, 0) == static_cast<ssize_t>(sizeof request))
    size = ::recv(kernel, answer, sizeof answer, 0);
  ::close(kernel);
  if (size < static_cast<ssize_t>(NLMSG_LENGTH(sizeof(inet_diag_msg)))) return false;
  const auto* const head = reinterpret_cast<const nlmsghdr*>(answer);
  if (head->nlmsg_type != SOCK_DIAG_BY_FAMILY) return false;
  user = static_cast<const inet_diag_msg*>(NLMSG_DATA(head))->idiag_uid;
  return true;
}

}  // namespace

bool IsOfOwnUser(int socket) {
  sockaddr_storage own{}, other{};
  socklen_t own_size = sizeof own, other_size = sizeof other;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &own_size) != 0) return false;
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&other), &other_size) != 0) return false;
  DiagRequest request;
  request.head.nlmsg_len = sizeof request;
  request.head.nlmsg_type = SOCK_DIAG_BY_FAMILY;
  request.head.nlmsg_flags = NLM_F_REQUEST;
  request.body.sdiag_protocol = IPPROTO_TCP;
  request.body.idiag_states = ~0u;
  inet_diag_sockid& id = request.body.id;
  id.idiag_cookie[0] = id.idiag_cookie[1] = INET_DIAG_NOCOOKIE;
  // Seen from the other end, this one is the destination.
  uint8_t family = 0;
  if (!SetEnd(other, family, id.idiag_sport, id.idiag_src)) return false;
  if (!SetEnd(own, request.body.sdiag_family, id.idiag_dport, id.idiag_dst)) return false;
  uid_t user = 0;
  return family == request.body.sdiag_family && AskUser(request, user) && user == ::geteuid() &&
         user != kOverflowUser;
}

}  // namespace tessera
