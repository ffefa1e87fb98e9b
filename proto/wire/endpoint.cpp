#include "proto/wire/endpoint.h"

#include <fmt/format.h>

#include <filesystem>

#include "proto/identity/subject.h"
#include "proto/wire/local_socket.h"

namespace tessera {

Result<Endpoint> EndpointOf(const Login& login) {
  auto address = ParseAddress(login.address, login.folder);
  if (!address) return address.error();
  const auto certificate = ReadIdentity(login);
  if (!certificate) return certificate.error();
  if (certificate->NotAfter() > UnixNow()) return Endpoint(*address, *address, login);
  return Failed(
      fmt::format("{}: the certificate of the login \"{}\" expired on {}; ask an operator of the farm for a "
                  "token and join again",
                  login.address, login.farm, UnixTimeText(certificate->NotAfter())));
}

namespace {

Result<Endpoint> EndpointOfOrganisation(const Address& address, const TlsFiles& files) {
  if (files.certificate.empty() || files.key.empty() || files.authority.empty())
    return BadInput("--tls-cert, --tls-key and --tls-ca belong together: give all three");
  const auto identity = ReadTlsIdentity(files, CertificatePurpose::kClient, UnixNow());
  if (!identity) return identity.error();
  const auto subject = Subject::Parse(identity->chain.front().Uri());
  if (!subject || !subject->IsOfOrganisation()) {
    return Failed(fmt::format(
        "{}: the certificate names no member: it needs exactly one URI, tessera:ROLE/NAME, as its "
        "subject alternative name",
        files.certificate));
  }
  if (const auto authorities = ReadTlsAuthorities(files); !authorities) return authorities.error();
  return Endpoint(address, files);
}

}  // namespace

Result<Endpoint> ChooseEndpoint(const Address& address, const EndpointRules& rules) {
  if (address.kind == Address::Kind::kUnix) return Endpoint(address);
  if (rules.insecure) {
    if (address.IsLocal()) return Endpoint(address);
    return BadInput(
        fmt::format("{}: --insecure is for addresses of this machine alone, such as 127.0.0.1; {}",
                    address.Text(), rules.advice));
  }
  if (rules.organisation.IsUsed()) return EndpointOfOrganisation(address, rules.organisation);
  const auto socket = LocalSocketOf(address, rules.socket_folder);
  if (rules.prefer_local_socket && socket && IsListening(*socket))
    return Endpoint{address, *socket, std::nullopt};
  if (const auto login = rules.logins.FindAddress(address.Text())) return EndpointOf(*login);
  // A coordinator of this user may be about to start on an address of this machine.
  if (socket && (address.IsLocal() || std::filesystem::exists(socket->path)))
    return Endpoint{address, *socket, std::nullopt};
  return BadInput(
      fmt::format("{}: there is no login for this coordinator; ask its operator for a token "
                  "(tessera-coordinator token) and {}",
                  address.Text(), rules.advice));
}

}  // namespace tessera
