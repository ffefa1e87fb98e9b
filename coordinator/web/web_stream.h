// The bytes of a connection, plain or encrypted. The socket does not block and is closed at the end.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "proto/identity/tls_server.h"

namespace tessera {

class WebStream {
 public:
  using Step = TlsStream::Step;
  // Takes over the socket. `tls` is null for a plain connection.
  WebStream(int socket, const TlsServer* tls);
  ~WebStream();
  WebStream(const WebStream&) = delete;
  WebStream& operator=(const WebStream&) = delete;

  int socket() const { return socket_; }
  // See TlsStream.
  Step Handshake();
  Step Read(char* bytes, size_t size, size_t& received);
  Step Write(std::string_view bytes, size_t& sent);
  // Nothing more will be sent.
  void EndWriting();
  // Receives and drops bytes, encrypted or not, and returns their number.
  size_t Drop(bool& is_open);
  std::optional<Certificate> PeerCertificate() const;
  std::string reason() const;

 private:
  const int socket_;
  std::optional<TlsStream> tls_;
};

}  // namespace tessera
