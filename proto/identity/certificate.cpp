#include "proto/identity/certificate.h"

#include <arpa/inet.h>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>

#include "proto/identity/openssl_handles.h"

namespace tessera {
namespace {

using NamesOwner = OpensslOwner<GENERAL_NAMES, GENERAL_NAMES_free>;

UnixTime TimeOf(const ASN1_TIME* time) {
  std::tm fields{};
  // Times that cannot be read count as 1970: the certificate has expired.
  return ASN1_TIME_to_tm(time, &fields) == 1 ? ::timegm(&fields) : 0;
}

std::string TextOf(const ASN1_STRING* text) {
  return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
          static_cast<size_t>(ASN1_STRING_length(text))};
}

NamesOwner NamesOf(X509* certificate) {
  return NamesOwner(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
}

// Calls `visit` with each name of a certificate.
template <typename Visit>
void VisitNames(X509* certificate, Visit visit) {
  const NamesOwner names = NamesOf(certificate);
  for (int i = 0; i < sk_GENERAL_NAME_num(names.get()); ++i) visit(*sk_GENERAL_NAME_value(names.get(), i));
}

std::string AddressText(const ASN1_OCTET_STRING* bytes) {
  const int size = ASN1_STRING_length(bytes);
  char text[INET6_ADDRSTRLEN] = "";
  if (size == 4 || size == 16)
    ::inet_ntop(size == 4 ? AF_INET : AF_INET6, ASN1_STRING_get0_data(bytes), text, sizeof text);
  return text;
}

int PurposeOf(CertificatePurpose purpose) {
  return purpose == CertificatePurpose::kClient ? X509_PURPOSE_SSL_CLIENT : X509_PURPOSE_SSL_SERVER;
}

CertificateVerdict VerdictOf(int error) {
  switch (error) {
    case X509_V_OK: return CertificateVerdict::kGood;
    case X509_V_ERR_CERT_HAS_EXPIRED: return CertificateVerdict::kExpired;
    case X509_V_ERR_CERT_NOT_YET_VALID: return CertificateVerdict::kNotYetValid;
    case X509_V_ERR_INVALID_PURPOSE: return CertificateVerdict::kWrongPurpose;
    default: return CertificateVerdict::kNotIssuedHere;
  }
}

}  // namespace

UnixTime UnixNow() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string UnixTimeText(UnixTime time) {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(static_cast<std::time_t>(time)));
}

Certificate::Certificate(x509_st* certificate) : certificate_(certificate, X509_free) {
  TESSERA_CHECK(certificate != nullptr);
}

Result<Certificate> Certificate::FromPem(std::string_view pem, const std::string& what) {
  auto chain = ChainFromPem(pem, what);
  if (!chain) return chain.error();
  return chain->front();
}

Result<std::vector<Certificate>> Certificate::ChainFromPem(std::string_view pem, const std::string& what,
                                                           size_t count_max) {
  if (pem.size() > count_max * kCertificateBytesMax) {
    return BadInput(fmt::format("{}: is too large for certificates (limit {} bytes)", what,
                                count_max * kCertificateBytesMax));
  }
  const BioOwner bio = ReadOnlyBio(pem);
  std::vector<Certificate> chain;
  while (X509* const next = PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr)) {
    if (chain.size() == count_max) {
      X509_free(next);
      return BadInput(fmt::format("{}: holds more than {} certificates", what, count_max));
    }
    chain.emplace_back(next);
  }
  if (chain.empty()) return BadInput(fmt::format("{}: holds no certificate in PEM form", what));
  return chain;
}

std::string Certificate::Pem() const {
  return BioText([this](BIO* bio) { return PEM_write_bio_X509(bio, certificate_.get()); });
}

Digest Certificate::Fingerprint() const {
  return Sha256(BioText([this](BIO* bio) { return i2d_X509_bio(bio, certificate_.get()); }));
}

Digest Certificate::KeyDigest() const {
  EVP_PKEY* const key = X509_get0_pubkey(certificate_.get());
  if (key == nullptr) return {};
  return Sha256(BioText([key](BIO* bio) { return i2d_PUBKEY_bio(bio, key); }));
}

UnixTime Certificate::NotBefore() const {
  return TimeOf(X509_get0_notBefore(certificate_.get()));
}

UnixTime Certificate::NotAfter() const {
  return TimeOf(X509_get0_notAfter(certificate_.get()));
}

std::string Certificate::CommonName() const {
  const X509_NAME* const name = X509_get_subject_name(certificate_.get());
  const int at = X509_NAME_get_index_by_NID(name, NID_commonName, -1);
  return at < 0 ? "" : TextOf(X509_NAME_ENTRY_get_data(X509_NAME_get_entry(name, at)));
}

std::string Certificate::Uri() const {
  std::vector<std::string> found;
  VisitNames(certificate_.get(), [&](const GENERAL_NAME& name) {
    if (name.type == GEN_URI) found.push_back(TextOf(name.d.uniformResourceIdentifier));
  });
  return found.size() == 1 ? found.front() : "";
}

std::vector<std::string> Certificate::HostNames() const {
  std::vector<std::string> found;
  VisitNames(certificate_.get(), [&](const GENERAL_NAME& name) {
    if (name.type == GEN_DNS) found.push_back(TextOf(name.d.dNSName));
    if (name.type == GEN_IPADD) found.push_back(AddressText(name.d.iPAddress));
  });
  return found;
}

bool Certificate::IsForHost(const std::string& host) const {
  if (host.empty() || host.front() == '.') return false;  // a leading dot would stand for any name before it
  return X509_check_ip_asc(certificate_.get(), host.c_str(), 0) == 1 ||
         X509_check_host(certificate_.get(), host.data(), host.size(), X509_CHECK_FLAG_NEVER_CHECK_SUBJECT,
                         nullptr) == 1;
}

bool Certificate::IsMeantFor(CertificatePurpose purpose) const {
  return X509_check_purpose(certificate_.get(), PurposeOf(purpose), 0) == 1;
}

CertificateVerdict CheckCertificate(const std::vector<Certificate>& chain,
                                    const std::vector<Certificate>& authorities, CertificatePurpose purpose,
                                    UnixTime now) {
  if (chain.empty()) return CertificateVerdict::kNotIssuedHere;
  const OpensslOwner<X509_STORE, X509_STORE_free> store(X509_STORE_new());
  const OpensslOwner<X509_STORE_CTX, X509_STORE_CTX_free> context(X509_STORE_CTX_new());
  struct StackDeleter {
    void operator()(STACK_OF(X509) * stack) const { sk_X509_free(stack); }
  };
  const std::unique_ptr<STACK_OF(X509), StackDeleter> others(sk_X509_new_null());
  TESSERA_CHECK(store && context && others);
  for (const Certificate& each : authorities) X509_STORE_add_cert(store.get(), each.get());
  for (const Certificate& each : chain) sk_X509_push(others.get(), each.get());
  TESSERA_CHECK(X509_STORE_CTX_init(context.get(), store.get(), chain.front().get(), others.get()) == 1);
  X509_VERIFY_PARAM* const parameters = X509_STORE_CTX_get0_param(context.get());
  X509_VERIFY_PARAM_set_time(parameters, static_cast<std::time_t>(now));
  X509_VERIFY_PARAM_set_purpose(parameters, PurposeOf(purpose));
  if (X509_verify_cert(context.get()) == 1) return CertificateVerdict::kGood;
  return VerdictOf(X509_STORE_CTX_get_error(context.get()));
}

}  // namespace tessera
