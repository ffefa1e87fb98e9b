#include "proto/identity/socket_bio.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstdint>

#include "proto/identity/openssl_handles.h"

namespace tessera {
namespace {

using MethodOwner = OpensslOwner<BIO_METHOD, BIO_meth_free>;

int SocketOf(BIO* bio) {
  return static_cast<int>(reinterpret_cast<intptr_t>(BIO_get_data(bio)));
}

bool IsTemporary(ssize_t result) {
  return result < 0 && (errno == EAGAIN || errno == EINTR);
}

int Send(BIO* bio, const char* bytes, int size) {
  BIO_clear_retry_flags(bio);
  const ssize_t sent = ::send(SocketOf(bio), bytes, static_cast<size_t>(size), MSG_NOSIGNAL);
  if (IsTemporary(sent)) BIO_set_retry_write(bio);
  return static_cast<int>(sent);
}

int Receive(BIO* bio, char* bytes, int size) {
  BIO_clear_retry_flags(bio);
  const ssize_t received = ::recv(SocketOf(bio), bytes, static_cast<size_t>(size), 0);
  if (IsTemporary(received)) BIO_set_retry_read(bio);
  return static_cast<int>(received);
}

long Control(BIO*, int command, long, void*) {
  return command == BIO_CTRL_FLUSH ? 1 : 0;
}

MethodOwner SocketMethod() {
  MethodOwner method(BIO_meth_new(BIO_TYPE_SOURCE_SINK, "socket without signals"));
  TESSERA_CHECK(method != nullptr && BIO_meth_set_write(method.get(), Send) == 1 &&
                BIO_meth_set_read(method.get(), Receive) == 1 &&
                BIO_meth_set_ctrl(method.get(), Control) == 1);
  return method;
}

}  // namespace

BIO* MakeSocketBio(int socket) {
  static const MethodOwner method = SocketMethod();  // never changes
  BIO* const bio = BIO_new(method.get());
  TESSERA_CHECK(bio != nullptr);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): what belongs to a BIO is a pointer.
  BIO_set_data(bio, reinterpret_cast<void*>(static_cast<intptr_t>(socket)));
  BIO_set_init(bio, 1);
  return bio;
}

}  // namespace tessera
