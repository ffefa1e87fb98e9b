// A coordinator with members that call it over TLS, beside the calls over its Unix socket.
#pragma once

#include <gmock/gmock.h>

#include <map>
#include <stdexcept>

#include "proto/access.grpc.pb.h"
#include "proto/identity/authority.h"
#include "proto/wire/convert_access.h"
#include "proto/wire/membership_calls.h"
#include "proto/wire/tls_credentials.h"
#include "tests/coordinator/services_fixture.h"

namespace tessera {

class ServicesForMembers : public Services {
 protected:
  ServicesForMembers() {
    more_addresses = {"127.0.0.1:0"};
    Restart();
  }
  // Members keep their certificates.
  void Restart() {
    coordinator.reset();
    Start();
    access = proto::Access::NewStub(channel);
    more_addresses = {tls_address().Text()};
  }
  const Address& tls_address() const { return coordinator->addresses().back(); }

  JoinToken IssueToken(Role role, const std::string& name, uint32_t uses = 1, uint64_t lifetime_s = 600) {
    const JoinToken token = JoinToken::Make(tls_address().Text(), *coordinator->authority_fingerprint());
    proto::TokenRequest request;
    request.set_key(WriteDigest(token.Key().PublicDigest()));
    request.set_role(WriteRole(role));
    request.set_name(name);
    request.set_lifetime_s(lifetime_s);
    request.set_uses(uses);
    proto::TokenAnswer answer;
    const grpc::Status status = Call(*LocalAccess(), &proto::Access::Stub::IssueToken, request, answer);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return token;
  }
  // A new member of this name.
  JoinedFarm Join(Role role, const std::string& name) {
    auto joined = JoinFarm(IssueToken(role, name), "");
    if (!joined) throw std::runtime_error(joined.error().message);
    return std::move(*joined);
  }
  std::shared_ptr<grpc::Channel> ChannelOf(const JoinedFarm& member) const {
    const IssuedIdentity& identity = member.identity;
    return OpenChannel(tls_address(), TlsClientCredentials(identity.authority_pem, identity.key.Pem(),
                                                           identity.certificate_pem));
  }
  // A connection that shows the key of a token.
  std::shared_ptr<grpc::Channel> ChannelOf(const JoinToken& token, const JoinedFarm& authority_of) const {
    return OpenChannel(tls_address(),
                       TlsClientCredentials(authority_of.identity.authority_pem, token.Key().Pem(),
                                            token.MakeCertificate(UnixNow()).Pem()));
  }
  // Makes the calls of the fixture those of this member from now on.
  void CallAs(const JoinedFarm& member) { Connect(ChannelOf(member)); }
  void CallAsLocalUser() { Connect(OpenChannel(coordinator->addresses().front())); }
  void Revoke(const std::string& which) {
    proto::RevokeRequest request;
    request.set_which(which);
    proto::AccessAnswer answer;
    const grpc::Status status = Call(*LocalAccess(), &proto::Access::Stub::Revoke, request, answer);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  std::unique_ptr<proto::Access::Stub> access;

 private:
  // Of an operator, whoever the calls of the fixture are by.
  std::unique_ptr<proto::Access::Stub> LocalAccess() const {
    return proto::Access::NewStub(OpenChannel(coordinator->addresses().front()));
  }
  void Connect(std::shared_ptr<grpc::Channel> connection) {
    channel = std::move(connection);
    jobs = proto::Jobs::NewStub(channel);
    blobs = proto::Blobs::NewStub(channel);
    work = proto::Work::NewStub(channel);
    access = proto::Access::NewStub(channel);
  }
};

}  // namespace tessera
