// The private certificate authority of a farm. It issues the certificate of the coordinator and those of
// members. Requests for certificates carry a public key and nothing else that is believed: name, role and
// lifetime are the issuer's decision.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "proto/identity/certificate.h"
#include "proto/identity/private_key.h"

namespace tessera {

// What a certificate states.
struct CertificateTerms {
  std::string common_name;              // for people
  std::string uri;                      // for programs: see subject.h
  std::vector<std::string> host_names;  // names and numeric addresses
  CertificatePurpose purpose = CertificatePurpose::kClient;
  std::chrono::seconds lifetime{};
  uint64_t serial = 0;  // not 0
};

// Certificates are valid from this long ago, so that clocks may differ.
constexpr std::chrono::hours kClockTolerance{1};

// Asks for a certificate of the key, in PEM form.
std::string MakeSigningRequest(const PrivateKey& key);

class Authority {
 public:
  // A new authority with a certificate for ten years: when it expires, a farm starts anew.
  static Authority Make(const std::string& common_name, UnixTime now);
  // From its key and its certificate in one PEM text; `what` names it in errors.
  static Result<Authority> FromPem(std::string_view pem, const std::string& what);
  std::string Pem() const;
  const Certificate& certificate() const { return certificate_; }

  // Signs the key of a request. Refuses requests that are too large or damaged, that do not prove the
  // possession of the key, and keys of another kind than P-256.
  Result<Certificate> Sign(std::string_view request_pem, const CertificateTerms& terms, UnixTime now) const;
  Certificate Issue(const PrivateKey& key, const CertificateTerms& terms, UnixTime now) const;

 private:
  Authority(PrivateKey key, Certificate certificate)
      : key_(std::move(key)), certificate_(std::move(certificate)) {}
  PrivateKey key_;
  Certificate certificate_;
};

// A certificate that only shows the possession of its key.
Certificate MakeSelfSigned(const PrivateKey& key, const CertificateTerms& terms, UnixTime now);

}  // namespace tessera
