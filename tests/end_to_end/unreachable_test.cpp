// Programs that reach no coordinator give the reason.
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "proto/identity/authority.h"
#include "proto/identity/login.h"
#include "tests/end_to_end/farm_fixture.h"
#include "tests/listening_socket.h"

namespace tessera {
namespace {

using testing::HasSubstr;

// Answers every connection as an old web server does.
class WebServer {
 public:
  WebServer() : thread_([this] { Serve(); }) {}
  ~WebServer() {
    ::shutdown(socket_.fd(), SHUT_RDWR);
    thread_.join();
  }
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  std::string address() const { return socket_.address(); }

 private:
  void Serve() const {
    constexpr std::string_view kAnswer = "HTTP/1.1 400 Bad Request\r\n\r\n";
    while (true) {
      const int peer = ::accept(socket_.fd(), nullptr, nullptr);
      if (peer < 0) return;
      char request[256];
      if (::recv(peer, request, sizeof request, 0) > 0) {
        const ssize_t sent = ::send(peer, kAnswer.data(), kAnswer.size(), MSG_NOSIGNAL);
        EXPECT_GT(sent, 0);
      }
      ::close(peer);
    }
  }

  const ListeningSocket socket_{16};
  std::thread thread_;
};

class Unreachable : public EndToEnd {
 protected:
  // A worker and a command at this address both give this reason within some seconds. A login that was made
  // up lets them try other machines.
  void ExpectReason(const std::string& where, const std::string& reason) {
    Process worker(folder(), "tessera-worker",
                   {"--coordinator", where, "--threads", "1", "--cache-dir", Path("cache")});
    const auto has_reason = [&] { return worker.Errors().find(reason) != std::string::npos; };
    EXPECT_TRUE(Eventually(has_reason, std::chrono::seconds(15))) << where << ":\n" << worker.Errors();
    EXPECT_THAT(worker.Errors(), HasSubstr("coordinator_unreachable address=" + where));
    const Outcome outcome = Tessera({"jobs", "--coordinator", where, "--patience", "2"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.errors, HasSubstr(reason)) << where;
    worker.Signal(SIGTERM);
    EXPECT_EQ(worker.Wait(), 0);
  }
};

TEST_F(Unreachable, AnUnknownHostIsNamed) {
  // A login lets both try another machine.
  const Authority authority = Authority::Make("farm", UnixNow());
  CertificateTerms terms;
  terms.lifetime = std::chrono::hours(1);
  terms.serial = 7;
  const PrivateKey key = PrivateKey::Generate();
  const IssuedIdentity identity{key, authority.Issue(key, terms, UnixNow()).Pem(),
                                authority.certificate().Pem()};
  for (const char* store : {"state/tessera/worker/farms", "config/tessera/farms"}) {
    const auto saved = LoginStore(Path(store)).Save("studio", "no-such-host.invalid:7700", identity);
    ASSERT_TRUE(saved) << saved.error().message;
  }
  ExpectReason("no-such-host.invalid:7700", "the host name");
}

TEST_F(Unreachable, ARefusedConnectionIsNamed) {
  StartCoordinator();
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  ExpectReason(address(), "connection refused");
}

TEST_F(Unreachable, AProgramThatIsNoCoordinatorIsNamed) {
  const WebServer server;
  ExpectReason(server.address(), "not a Tessera coordinator");
}

TEST_F(Unreachable, AWorkerThatIsRefusedAtFirstJoinsLater) {
  StartCoordinator();
  coordinator().Signal(SIGKILL);
  coordinator().Wait();
  Process& worker = StartWorker("patient");
  ASSERT_TRUE(worker.AwaitErrors("coordinator_unreachable"));
  StartCoordinator();
  EXPECT_TRUE(worker.AwaitErrors("connected worker="));
}

}  // namespace
}  // namespace tessera
