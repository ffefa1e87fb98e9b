// X.509 certificates as values.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "proto/membership.h"
#include "renderer/util/digest.h"
#include "renderer/util/result.h"

struct x509_st;  // OpenSSL's X509

namespace tessera {

UnixTime UnixNow();
// As in "2026-11-29 04:56 UTC".
std::string UnixTimeText(UnixTime time);

// Of one chain. Ours have two, those of an organisation may have some more, and a coordinator may show both.
constexpr size_t kChainMax = 16;
constexpr size_t kCertificateBytesMax = 4 << 10;

// What the holder of a certificate does in a TLS connection.
enum class CertificatePurpose { kClient, kServer };

// Copies share the certificate, which never changes. Thread safe.
class Certificate {
 public:
  // Takes over the object.
  explicit Certificate(x509_st* certificate);
  // The first certificate in some PEM text; `what` names the text in errors.
  static Result<Certificate> FromPem(std::string_view pem, const std::string& what);
  // All certificates in some PEM text, at least one and at most `count_max`, each of 4 KiB on average.
  static Result<std::vector<Certificate>> ChainFromPem(std::string_view pem, const std::string& what,
                                                       size_t count_max = kChainMax);

  std::string Pem() const;
  Digest Fingerprint() const;  // SHA-256 of the certificate
  Digest KeyDigest() const;    // PrivateKey::PublicDigest of its key
  UnixTime NotBefore() const;
  UnixTime NotAfter() const;
  std::string CommonName() const;
  // The URI that it stands for; empty if it has none or several.
  std::string Uri() const;
  // The host names and addresses that it is for.
  std::vector<std::string> HostNames() const;
  // Whether it is for this name or numeric address, also by a wildcard; an IPv6 number has no brackets.
  bool IsForHost(const std::string& host) const;
  // Whether its extensions allow this use.
  bool IsMeantFor(CertificatePurpose purpose) const;
  x509_st* get() const { return certificate_.get(); }

 private:
  std::shared_ptr<x509_st> certificate_;
};

// Why a certificate is not accepted.
enum class CertificateVerdict { kGood, kNotIssuedHere, kExpired, kNotYetValid, kWrongPurpose };

// Whether one of `authorities` issued the first certificate of `chain`, if need be through the others, for
// this purpose and time.
CertificateVerdict CheckCertificate(const std::vector<Certificate>& chain,
                                    const std::vector<Certificate>& authorities, CertificatePurpose purpose,
                                    UnixTime now);

}  // namespace tessera
