#include "proto/wire/membership_calls.h"

#include <fmt/format.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <chrono>

#include "proto/access.grpc.pb.h"
#include "proto/identity/authority.h"
#include "proto/identity/private_file.h"
#include "proto/terms.h"
#include "proto/wire/address.h"
#include "proto/wire/channel.h"
#include "proto/wire/convert.h"
#include "proto/wire/convert_access.h"
#include "proto/wire/reachability.h"
#include "proto/wire/tls_credentials.h"

namespace tessera {
namespace {

constexpr std::chrono::seconds kJoinPatience{10};
constexpr std::chrono::seconds kAnswerPatience{30};
// A worker that stops waits for this call.
constexpr std::chrono::seconds kRenewalPatience{5};
// A certificate is renewed when this part of its life is over, so that there is time for many attempts.
constexpr int kRenewAfterPart = 3;

// The authority of the coordinator at the address of the token, if it is the one that the token names.
Result<Certificate> FetchAuthority(const JoinToken& token, const Address& address) {
  const auto chain = FetchCertificates(address);
  if (!chain)
    return Failed(fmt::format("{}: cannot join the farm: {}", token.address, chain.error().message));
  const auto authority = std::ranges::find(*chain, token.authority, &Certificate::Fingerprint);
  if (authority != chain->end()) return *authority;
  return Failed(
      fmt::format("{}: cannot join the farm: the coordinator there is not the one that made the token "
                  "(fingerprint {}, the token "
                  "names {}); use a token of this farm, and if it is one, somebody intercepts the connection",
                  token.address, chain->back().Fingerprint().Hex(), token.authority.Hex()));
}

}  // namespace

Result<JoinedFarm> JoinFarm(const JoinToken& token, const std::string& name) {
  const auto address = ParseAddress(token.address, "token");
  if (!address) return address.error();
  if (address->kind != Address::Kind::kTcp) return BadInput("the token does not name a TCP address");
  const auto authority = FetchAuthority(token, *address);
  if (!authority) return authority.error();
  if (auto started = StartGrpc(); !started) return started.error();
  const auto channel = OpenChannel(*address, TlsClientCredentials(authority->Pem(), token.Key().Pem(),
                                                                  token.MakeCertificate(UnixNow()).Pem()));
  // The coordinator closes connections with tokens that it does not know.
  if (!WaitForConnection(*channel, kJoinPatience)) {
    return Failed(
        fmt::format("{}: cannot join the farm: the coordinator does not accept the token: it has expired "
                    "long ago, or it was made "
                    "by another farm; ask an operator for another",
                    token.address));
  }
  const PrivateKey key = PrivateKey::Generate();
  proto::JoinRequest request;
  request.set_signing_request(MakeSigningRequest(key));
  request.set_name(CleanName(name));
  proto::JoinAnswer answer;
  grpc::ClientContext context;
  SetDeadline(context, kAnswerPatience);
  const grpc::Status status = proto::Access::NewStub(channel)->Join(&context, request, &answer);
  if (!status.ok()) return ToError(status, "join the farm");
  const auto role = ReadRole(answer.role());
  if (!role) return role.error();
  const auto certificate = Certificate::FromPem(answer.certificate(), "the new certificate");
  if (!certificate) return certificate.error();
  if (certificate->KeyDigest() != key.PublicDigest())
    return Failed("the coordinator sent a certificate of another key");
  return JoinedFarm{{key, answer.certificate(), authority->Pem()},
                    MemberId{answer.member()},
                    *role,
                    CleanName(answer.name())};
}

Result<bool> RenewIfDue(const Login& login, const std::shared_ptr<grpc::Channel>& channel) {
  const auto present = ReadIdentity(login);
  if (!present) return present.error();
  const UnixTime life = present->NotAfter() - present->NotBefore();
  if (UnixNow() < present->NotBefore() + life / kRenewAfterPart) return false;
  const PrivateKey key = PrivateKey::Generate();
  proto::RenewRequest request;
  request.set_signing_request(MakeSigningRequest(key));
  proto::RenewAnswer answer;
  grpc::ClientContext context;
  SetDeadline(context, kRenewalPatience);
  const grpc::Status status = proto::Access::NewStub(channel)->Renew(&context, request, &answer);
  if (!status.ok()) return ToError(status, "renew the certificate");
  const auto certificate = Certificate::FromPem(answer.certificate(), "the new certificate");
  if (!certificate || certificate->KeyDigest() != key.PublicDigest())
    return Failed("cannot renew the certificate: the coordinator sent one of another key");
  if (auto written = WritePrivateFile(login.IdentityPath(), key.Pem() + answer.certificate()); !written)
    return written.error();
  return true;
}

}  // namespace tessera
