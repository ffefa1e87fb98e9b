#include "coordinator/membership/peer_check.h"

namespace tessera {
namespace {

// A certificate that only shows that its holder has a key may state anything, so it has to state exactly
// this.
bool IsOfToken(const Certificate& certificate, const Subject& subject, const MemberBoard& board) {
  const Digest key = certificate.KeyDigest();
  return subject.token_key == key && board.FindToken(key).has_value();
}

}  // namespace

Result<void> CheckPeer(const std::vector<Certificate>& chain, const Certificate& authority,
                       const std::vector<Certificate>& organisation, const MemberBoard& board, UnixTime now) {
  if (chain.empty()) return Failed("the peer shows no certificate");
  const auto subject = Subject::Parse(chain.front().Uri());
  if (!subject) return Failed("the certificate is not one of this farm: it names no member");
  if (!subject->IsMember()) {
    if (IsOfToken(chain.front(), *subject, board)) return {};
    return Failed("the token is not one of this farm");
  }
  // Neither kind of authority issues certificates of the other's kind.
  const bool is_foreign = subject->IsOfOrganisation();
  if (is_foreign && organisation.empty())
    return Failed(
        "the certificate is one of an organisation, and the coordinator was started without --tls-ca");
  const std::vector<Certificate> issuers = is_foreign ? organisation : std::vector{authority};
  switch (CheckCertificate(chain, issuers, CertificatePurpose::kClient, now)) {
    case CertificateVerdict::kGood:
    case CertificateVerdict::kExpired: return {};
    case CertificateVerdict::kNotYetValid:
      return Failed("the certificate is not valid yet: the clock of one of the machines is wrong");
    case CertificateVerdict::kWrongPurpose: return Failed("the certificate is not that of a member");
    case CertificateVerdict::kNotIssuedHere: break;
  }
  return Failed(is_foreign ? "the certificate was not issued by an authority in the file of --tls-ca"
                           : "the certificate was not issued by this farm");
}

}  // namespace tessera
