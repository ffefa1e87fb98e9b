// Whether the server at the other end is the coordinator that a client wants to reach.
//
// The authority of a farm issues a certificate of the coordinator's key for the name kCoordinatorName, and
// members check that name instead of the address. A coordinator with a certificate of an organisation shows
// both, for the same key: the handshake proves the key, and either certificate says whose it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/identity/certificate.h"

namespace tessera {

struct ServerVerdict {
  CertificateVerdict verdict = CertificateVerdict::kNotIssuedHere;
  // The certificate that was judged; none if the server shows none that claims to be a coordinator's.
  std::optional<Certificate> certificate;
  bool is_for_host = true;
  bool IsGood() const { return verdict == CertificateVerdict::kGood && is_for_host; }
};

// For members: whether one of the farm's authorities vouches for the key of the first certificate.
ServerVerdict CheckCoordinator(const std::vector<Certificate>& chain,
                               const std::vector<Certificate>& authorities, UnixTime now);
// For certificates of an organisation: whether the first certificate is one for `host`.
ServerVerdict CheckHost(const std::vector<Certificate>& chain, const std::vector<Certificate>& authorities,
                        const std::string& host, UnixTime now);

// Whether the server claims to be a coordinator, of whatever farm.
bool ClaimsCoordinator(const std::vector<Certificate>& chain);

}  // namespace tessera
