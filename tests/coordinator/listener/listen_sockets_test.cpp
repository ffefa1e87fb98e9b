// What a failure to accept a connection means.
#include "coordinator/listener/listen_sockets.h"

#include <gtest/gtest.h>

#include <cerrno>

namespace tessera {
namespace {

TEST(ListenSockets, OnlyFailuresThatPassByThemselvesAreTriedAgainWithoutAPause) {
  for (const int error : {EAGAIN, EWOULDBLOCK, EINTR, ECONNABORTED, EPROTO})
    EXPECT_FALSE(IsLastingAcceptFailure(error)) << error;
  for (const int error : {EMFILE, ENFILE, ENOBUFS, ENOMEM, EPERM, EINVAL})
    EXPECT_TRUE(IsLastingAcceptFailure(error)) << error;
}

}  // namespace
}  // namespace tessera
