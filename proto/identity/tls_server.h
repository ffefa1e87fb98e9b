// The server's end of TLS 1.3 connections, over sockets that do not block.
//
// A client may show a certificate, on which a function of the caller decides. Sessions are not resumed, so
// every connection is checked anew.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/identity/certificate.h"
#include "renderer/util/result.h"

namespace tessera {

// Key, certificate and rules of a server. Copies share them. Thread safe.
class TlsServer {
 public:
  // Decides on the certificate that a client has shown, whose chain begins with its own. The error is for the
  // log.
  using CheckClient = std::function<Result<void>(const std::vector<Certificate>& chain)>;

  // `certificate_pem` begins with the certificate of the key, and those that issued it follow. Clients learn
  // the names of `authorities`, so that browsers only offer certificates that these have issued.
  static Result<TlsServer> Make(const std::string& key_pem, const std::string& certificate_pem,
                                const std::vector<Certificate>& authorities, CheckClient check);
  const Certificate& certificate() const;

 private:
  friend class TlsStream;
  struct State;
  explicit TlsServer(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

// One connection. Not thread safe.
class TlsStream {
 public:
  // What a step has led to. After kAwaitRead and kAwaitWrite the step is repeated when the socket is ready.
  enum class Step { kDone, kAwaitRead, kAwaitWrite, kFailed };

  // The socket stays the caller's.
  TlsStream(const TlsServer& server, int socket);
  ~TlsStream();
  TlsStream(TlsStream&&) noexcept;
  TlsStream& operator=(TlsStream&&) noexcept;

  // The first step.
  Step Handshake();
  // Receives at least one byte. A buffer of kRecordBytesMax takes all that a ready socket stands for.
  Step Read(char* bytes, size_t size, size_t& received);
  // Sends some of the bytes.
  Step Write(std::string_view bytes, size_t& sent);
  // Announces the end of what is sent.
  void Close();
  // The certificate that the client has shown, after the handshake.
  std::optional<Certificate> PeerCertificate() const;
  // Why a step has failed. Empty if the client has closed the connection.
  const std::string& reason() const;

  static constexpr size_t kRecordBytesMax = 16 << 10;

 private:
  friend class TlsServer;
  struct State;
  Step After(int result);
  std::unique_ptr<State> state_;
};

}  // namespace tessera
