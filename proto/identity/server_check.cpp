#include "proto/identity/server_check.h"

#include <algorithm>

#include "proto/identity/subject.h"

namespace tessera {
namespace {

bool IsForCoordinator(const Certificate& certificate) {
  const std::vector<std::string> names = certificate.HostNames();
  return std::ranges::find(names, kCoordinatorName) != names.end();
}

}  // namespace

bool ClaimsCoordinator(const std::vector<Certificate>& chain) {
  return std::ranges::any_of(chain, IsForCoordinator);
}

// Whoever has seen a coordinator's chain can send it, but not prove the key of the first certificate.
ServerVerdict CheckCoordinator(const std::vector<Certificate>& chain,
                               const std::vector<Certificate>& authorities, UnixTime now) {
  ServerVerdict best;
  for (const Certificate& each : chain) {
    if (!IsForCoordinator(each) || each.KeyDigest() != chain.front().KeyDigest()) continue;
    std::vector<Certificate> path{each};
    path.insert(path.end(), chain.begin(), chain.end());
    const CertificateVerdict verdict = CheckCertificate(path, authorities, CertificatePurpose::kServer, now);
    if (!best.certificate || verdict == CertificateVerdict::kGood) best = {verdict, each};
  }
  return best;
}

ServerVerdict CheckHost(const std::vector<Certificate>& chain, const std::vector<Certificate>& authorities,
                        const std::string& host, UnixTime now) {
  if (chain.empty()) return {};
  return {CheckCertificate(chain, authorities, CertificatePurpose::kServer, now), chain.front(),
          chain.front().IsForHost(host)};
}

}  // namespace tessera
