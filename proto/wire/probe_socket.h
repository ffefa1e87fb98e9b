// A connection that finds out who answers at an address, and what interrupts it from another thread.
#pragma once

#include <netdb.h>
#include <sys/socket.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

namespace tessera {

// Ends the connections of one thread early. A name server that does not answer cannot be interrupted, so a
// thread that resolves a name may be left behind: nothing but this object is used by it until it returns.
// Thread safe.
class Interruption {
 public:
  // The current connection ends now, and no other starts. Returns whether the thread is resolving a name.
  bool Request();

  // Called by the thread itself. The first two return false if an interruption was requested.
  bool EnterResolving() { return SetResolving(true); }
  bool LeaveResolving() { return SetResolving(false); }
  void Start(int socket);
  void End();
  bool IsRequested();

 private:
  bool SetResolving(bool is_resolving);

  std::mutex mutex_;
  bool is_requested_ = false;
  bool is_resolving_ = false;
  int socket_ = -1;
};

// The addresses of a host.
struct ResolvedHost {
  int error = 0;  // of getaddrinfo; EAI_AGAIN if it was interrupted
  std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses{nullptr, &::freeaddrinfo};
};

ResolvedHost Resolve(const std::string& host, int port, Interruption& interruption);

// A stream socket that does not block. Owns its descriptor.
class ProbeSocket {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  ProbeSocket(int family, Interruption& interruption);
  ~ProbeSocket();
  ProbeSocket(const ProbeSocket&) = delete;
  ProbeSocket& operator=(const ProbeSocket&) = delete;
  int fd() const { return fd_; }
  // Returns 0 or an error number: ETIMEDOUT at the deadline, ECONNABORTED if it was interrupted.
  int Connect(const sockaddr* address, socklen_t size, TimePoint deadline) const;
  // Waits for `events`. Returns false at the deadline.
  bool Await(short events, TimePoint deadline) const;

 private:
  Interruption& interruption_;
  int fd_;
};

}  // namespace tessera
