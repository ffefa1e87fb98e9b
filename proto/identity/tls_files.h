// Files of an organisation's own certificates, as --tls-cert, --tls-key and --tls-ca name them.
#pragma once

#include <string>
#include <vector>

#include "proto/identity/certificate.h"
#include "proto/identity/private_key.h"

namespace tessera {

struct TlsFiles {
  std::string certificate;  // that of this program, then those that issued it
  std::string key;          // its key
  std::string
      authority;  // certificates that those of others must be issued by; may be empty on a coordinator

  bool operator==(const TlsFiles&) const = default;
  bool IsUsed() const { return !certificate.empty() || !key.empty() || !authority.empty(); }
};

struct TlsIdentity {
  PrivateKey key;
  std::vector<Certificate> chain;  // that of the key first
};

// Reads key and certificate. Fails if a file is missing or damaged, if the key does not belong to the
// certificate or everybody may read it, and if the certificate is not for this purpose or time. Each error
// names the file.
Result<TlsIdentity> ReadTlsIdentity(const TlsFiles& files, CertificatePurpose purpose, UnixTime now);
// Reads the certificates that others are checked with.
Result<std::vector<Certificate>> ReadTlsAuthorities(const TlsFiles& files);

}  // namespace tessera
