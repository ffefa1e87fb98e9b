#include "proto/wire/reachability.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <grpcpp/support/status.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <mutex>
#include <system_error>

#include "proto/identity/private_file.h"
#include "proto/identity/private_key.h"
#include "proto/identity/server_check.h"
#include "proto/identity/tls_probe.h"
#include "proto/wire/probe_socket.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

// For all addresses of a host together, and for the first bytes after that.
constexpr std::chrono::milliseconds kConnectPatience{3000};
constexpr std::chrono::milliseconds kGreetingPatience{2000};
// For name servers in addition, before the check is given up.
constexpr std::chrono::milliseconds kResolvePatience{5000};
// A local socket, its address in plain text and with TLS.
constexpr int kConnectionsMax = 3;

// What a client sends first (RFC 9113, 3.4): the preface and a SETTINGS frame without settings.
constexpr char kGreeting[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0";
constexpr size_t kGreetingBytes = sizeof kGreeting;
constexpr size_t kFrameHeaderBytes = 9;
constexpr size_t kFrameTypeAt = 3;
constexpr char kSettingsFrame = 4;

constexpr const char* kNotCoordinator = "the program that answers there is not a Tessera coordinator";

// A connection is there: finds out who answers.
Reachability Greet(const ProbeSocket& socket) {
  const auto deadline = Clock::now() + kGreetingPatience;
  if (::send(socket.fd(), kGreeting, kGreetingBytes, MSG_NOSIGNAL) != static_cast<ssize_t>(kGreetingBytes))
    return {false, "the program that listens there closes connections"};
  char header[kFrameHeaderBytes];
  size_t received = 0;
  while (received < sizeof header) {
    if (!socket.Await(POLLIN, deadline)) {
      return {false, received > 0 ? kNotCoordinator
                                  : "timed out: the program that listens there does not answer; is it a "
                                    "Tessera coordinator, and is it running?"};
    }
    const ssize_t count = ::recv(socket.fd(), header + received, sizeof header - received, 0);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) {
      return {false, received > 0 ? kNotCoordinator
                                  : "the program that listens there closes connections without an answer; it "
                                    "is not a Tessera coordinator or has too many connections"};
    }
    received += static_cast<size_t>(count);
  }
  if (header[kFrameTypeAt] != kSettingsFrame) return {false, kNotCoordinator, Obstacle::kOtherProgram};
  return {true, {}};
}

std::string ConnectError(int error, const Address& address) {
  const bool is_unix = address.kind == Address::Kind::kUnix;
  switch (error) {
    case ECONNREFUSED: return "connection refused: no program listens there";
    case ETIMEDOUT:
      return is_unix ? "timed out: the program that listens there accepts no connections"
                     : "timed out: the machine does not answer";
    case EHOSTUNREACH:
    case ENETUNREACH: return "no route to the machine";
    case ENOENT: return "the socket does not exist";
    case EACCES:
    case EPERM: return is_unix ? "no permission to use the socket" : "the connection is not permitted";
    default: return fmt::format("no connection: {}", std::generic_category().message(error));
  }
}

Obstacle ObstacleOf(int error) {
  switch (error) {
    case ECONNREFUSED:
    case ENOENT: return Obstacle::kRefused;
    case ETIMEDOUT: return Obstacle::kTimeout;
    case EHOSTUNREACH:
    case ENETUNREACH: return Obstacle::kNoRoute;
    default: return Obstacle::kOther;
  }
}

Reachability CheckUnix(const Address& address, Interruption& interruption) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (address.path.size() >= sizeof name.sun_path) return {false, "the path of the socket is too long"};
  std::memcpy(name.sun_path, address.path.data(), address.path.size());
  const ProbeSocket socket(AF_UNIX, interruption);
  const int error =
      socket.Connect(reinterpret_cast<const sockaddr*>(&name), sizeof name, Clock::now() + kConnectPatience);
  return error == 0 ? Greet(socket) : Reachability{false, ConnectError(error, address), ObstacleOf(error)};
}

std::string ResolveError(int error, const std::string& host) {
  switch (error) {
    case EAI_NONAME:
    case EAI_NODATA:
    case EAI_ADDRFAMILY: return fmt::format("the host name \"{}\" is unknown", host);
    case EAI_AGAIN: return fmt::format("the host name \"{}\" cannot be resolved at present", host);
    default: return fmt::format("the host name \"{}\" cannot be resolved: {}", host, ::gai_strerror(error));
  }
}

// Connects and calls `greet` with the connection.
Reachability CheckTcp(const Address& address, Interruption& interruption,
                      const std::function<Reachability(const ProbeSocket&)>& greet) {
  const ResolvedHost host = Resolve(address.host, address.port, interruption);
  if (host.error != 0) return {false, ResolveError(host.error, address.host), Obstacle::kName};
  const auto deadline = Clock::now() + kConnectPatience;
  int error = ETIMEDOUT;
  for (const addrinfo* each = host.addresses.get(); each != nullptr && Clock::now() < deadline;
       each = each->ai_next) {
    const ProbeSocket socket(each->ai_family, interruption);
    error = socket.Connect(each->ai_addr, each->ai_addrlen, deadline);
    if (error == 0) return greet(socket);
  }
  return {false, ConnectError(error, address), ObstacleOf(error)};
}

// What a client shows and expects in the handshake.
struct TlsGreeting {
  std::string identity_pem;  // key and certificates
  std::string own;           // "the certificate of the login "x"", for messages
  std::string remedy;        // if the coordinator does not accept it
  // Return an empty text if all is well.
  std::function<std::string(const std::vector<Certificate>& chain)> why_not_trusted;
  std::function<std::string()> why_not_usable = [] {
    return std::string();
  };  // as far as this machine can tell
};

std::string WhenValid(const Certificate& certificate) {
  return fmt::format("valid from {} to {}", UnixTimeText(certificate.NotBefore()),
                     UnixTimeText(certificate.NotAfter()));
}

std::string WhyNotOfFarm(const std::vector<Certificate>& chain, const Login& login) {
  const auto pem = ReadFile(login.AuthorityPath(), kPemBytesMax);
  if (!pem) return pem.error().message;
  const auto authorities = Certificate::ChainFromPem(*pem, login.AuthorityPath());
  if (!authorities) return authorities.error().message;
  const ServerVerdict found = CheckCoordinator(chain, *authorities, UnixNow());
  if (!found.certificate) return kNotCoordinator;
  switch (found.verdict) {
    case CertificateVerdict::kGood: return {};
    case CertificateVerdict::kExpired:
    case CertificateVerdict::kNotYetValid:
      return fmt::format(
          "the certificate of the coordinator is {}: restart the coordinator, or correct the clock of this "
          "machine",
          WhenValid(*found.certificate));
    default:
      return fmt::format(
          "the coordinator there is not one of the farm that the login \"{}\" is for (its authority has the "
          "fingerprint {}); join again with a token of it if it has replaced that farm",
          login.farm, chain.back().Fingerprint().Hex());
  }
}

std::string WhyLoginNotUsable(const Login& login) {
  const auto own = ReadIdentity(login);
  if (!own) return own.error().message;
  if (own->NotAfter() > UnixNow()) return {};
  return fmt::format("the certificate of the login \"{}\" expired on {}; join again with a new token",
                     login.farm, UnixTimeText(own->NotAfter()));
}

Result<TlsGreeting> GreetingOf(const Login& login) {
  auto identity = ReadPrivateFile(login.IdentityPath());
  if (!identity) return identity.error();
  return TlsGreeting{std::move(*identity), fmt::format("the certificate of the login \"{}\"", login.farm),
                     "join again with a new token",
                     [login](const auto& chain) { return WhyNotOfFarm(chain, login); },
                     [login] { return WhyLoginNotUsable(login); }};
}

std::string WhyNotTheHost(const std::vector<Certificate>& chain, const TlsFiles& files,
                          const std::string& host) {
  const auto authorities = ReadTlsAuthorities(files);
  if (!authorities) return authorities.error().message;
  const ServerVerdict found = CheckHost(chain, *authorities, host, UnixNow());
  if (found.IsGood()) return {};
  if (!found.certificate) return kNotCoordinator;
  if (found.verdict == CertificateVerdict::kGood) {
    return fmt::format("the certificate of the coordinator is for {}, not for {}; use one of these names",
                       fmt::join(found.certificate->HostNames(), ", "), host);
  }
  if (found.verdict == CertificateVerdict::kNotIssuedHere) {
    return fmt::format(
        "the certificate of the coordinator was not issued by an authority in {}; was the "
        "coordinator started with --tls-cert?",
        files.authority);
  }
  return fmt::format("the certificate of the coordinator is {} and cannot be used",
                     WhenValid(*found.certificate));
}

Result<TlsGreeting> GreetingOf(const TlsFiles& files, const std::string& host) {
  const auto identity = ReadTlsIdentity(files, CertificatePurpose::kClient, UnixNow());
  if (!identity) return identity.error();
  std::string pem = identity->key.Pem();
  for (const Certificate& each : identity->chain) pem += each.Pem();
  return TlsGreeting{
      std::move(pem), "the certificate in " + files.certificate,
      "the coordinator needs --tls-ca with the authority that issued it, and it must not be revoked",
      [files, host](const auto& chain) { return WhyNotTheHost(chain, files, host); }};
}

Reachability GreetTls(const ProbeSocket& socket, const Result<TlsGreeting>& greeting) {
  if (!greeting) return {false, greeting.error().message};
  const auto deadline = Clock::now() + kGreetingPatience;
  TlsProbe probe(socket.fd(), greeting->identity_pem);
  if (const auto done = probe.Handshake(deadline); !done)
    return {false,
            fmt::format("the TLS handshake failed ({}); is it a Tessera coordinator?", done.error().message),
            Obstacle::kOtherProgram};
  if (std::string why = greeting->why_not_trusted(probe.PeerChain()); !why.empty())
    return {false, std::move(why), Obstacle::kOtherFarm};
  const auto answer = probe.Exchange({kGreeting, kGreetingBytes}, kFrameHeaderBytes, deadline);
  if (answer) return {true, {}};
  if (std::string why = greeting->why_not_usable(); !why.empty())
    return {false, std::move(why), Obstacle::kNotAdmitted};
  return {false,
          fmt::format("the coordinator does not accept {} ({}); {}", greeting->own, answer.error().message,
                      greeting->remedy),
          Obstacle::kNotAdmitted};
}

Result<std::vector<Certificate>> CertificatesAt(const Address& address, Interruption& interruption) {
  std::vector<Certificate> chain;
  const Reachability found = CheckTcp(address, interruption, [&](const ProbeSocket& socket) -> Reachability {
    TlsProbe probe(socket.fd(), "");
    const auto done = probe.Handshake(Clock::now() + kGreetingPatience);
    if (!done) return {false, fmt::format("the TLS handshake failed ({})", done.error().message)};
    chain = probe.PeerChain();
    return {true, {}};
  });
  if (chain.empty()) return Failed(found.reason);
  return chain;
}

// Nobody listens on the local socket of the address: finds out who listens on the address itself.
Reachability CheckForeign(const Address& address, Interruption& interruption) {
  const Reachability found = CheckTcp(address, interruption, Greet);
  if (found.speaks_http2) {
    return {false,
            "the coordinator there was started with --insecure; add --insecure here too if that is wanted"};
  }
  const auto chain = CertificatesAt(address, interruption);
  if (!chain || !ClaimsCoordinator(*chain)) return found;
  return {false,
          "the coordinator there belongs to another user or machine, and there is no login for it; ask its "
          "operator for a token and join with it"};
}

Reachability CheckEndpoint(const Endpoint& endpoint, Interruption& interruption) {
  if (endpoint.login) {
    return CheckTcp(endpoint.address, interruption,
                    [&](const ProbeSocket& socket) { return GreetTls(socket, GreetingOf(*endpoint.login)); });
  }
  if (endpoint.organisation) {
    return CheckTcp(endpoint.address, interruption, [&](const ProbeSocket& socket) {
      return GreetTls(socket, GreetingOf(*endpoint.organisation, endpoint.address.host));
    });
  }
  if (endpoint.target.kind == Address::Kind::kTcp) return CheckTcp(endpoint.target, interruption, Greet);
  const Reachability found = CheckUnix(endpoint.target, interruption);
  return found.speaks_http2 || !endpoint.IsLocalSocket() ? found
                                                         : CheckForeign(endpoint.address, interruption);
}

}  // namespace

Result<std::vector<Certificate>> FetchCertificates(const Address& address) {
  Interruption never;
  return CertificatesAt(address, never);
}

bool IsWebServer(const Address& address, bool is_encrypted) {
  Interruption never;
  const std::string request =
      fmt::format("GET / HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", address.Text());
  const auto is_answer = [](std::string_view bytes) { return bytes.starts_with("HTTP/1."); };
  bool is_web = false;
  CheckTcp(address, never, [&](const ProbeSocket& socket) -> Reachability {
    const auto deadline = Clock::now() + kGreetingPatience;
    char answer[64];
    if (is_encrypted) {
      TlsProbe probe(socket.fd(), "");
      if (!probe.Handshake(deadline)) return {};
      const auto bytes = probe.Exchange(request, sizeof answer, deadline);
      is_web = bytes && is_answer(*bytes);
    } else if (::send(socket.fd(), request.data(), request.size(), MSG_NOSIGNAL) > 0 &&
               socket.Await(POLLIN, deadline)) {
      const ssize_t count = ::recv(socket.fd(), answer, sizeof answer, 0);
      is_web = count > 0 && is_answer({answer, static_cast<size_t>(count)});
    }
    return {};
  });
  return is_web;
}

struct ReachabilityCheck::Shared {
  Interruption interruption;
  std::mutex mutex;
  std::condition_variable_any ended;
  std::optional<Reachability> result;
};

ReachabilityCheck::ReachabilityCheck(const Endpoint& endpoint) : shared_(std::make_shared<Shared>()) {
  try {
    thread_ = std::thread([endpoint, shared = shared_] {
      Reachability result = CheckEndpoint(endpoint, shared->interruption);
      const std::lock_guard lock(shared->mutex);
      shared->result = std::move(result);
      shared->ended.notify_all();
    });
  } catch (const std::system_error&) {  // no thread
    shared_->result = Reachability{false, "it is not reached"};
  }
}

// A thread that uses OpenSSL must have ended before the program does, as OpenSSL frees its data at exit.
ReachabilityCheck::~ReachabilityCheck() {
  if (!thread_.joinable()) return;
  if (shared_->interruption.Request()) {
    thread_.detach();
  } else {
    thread_.join();
  }
}

std::optional<Reachability> ReachabilityCheck::Await(std::chrono::milliseconds patience,
                                                     std::stop_token stop) {
  std::unique_lock lock(shared_->mutex);
  shared_->ended.wait_for(lock, std::move(stop), patience, [this] { return shared_->result.has_value(); });
  return shared_->result;
}

Reachability CheckReachability(const Endpoint& endpoint, std::stop_token stop) {
  constexpr auto kPatience = kResolvePatience + kConnectionsMax * (kConnectPatience + kGreetingPatience);
  const auto result = ReachabilityCheck(endpoint).Await(kPatience, std::move(stop));
  return result.value_or(Reachability{false, "timed out: no name server answers"});
}

std::string DescribeOutage(const Reachability& found, const grpc::Status& status) {
  if (!found.speaks_http2) return found.reason;
  switch (status.error_code()) {
    case grpc::StatusCode::UNIMPLEMENTED: return kNotCoordinator;
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return "the coordinator is connected but does not answer in time";
    default: return status.error_message();
  }
}

}  // namespace tessera
