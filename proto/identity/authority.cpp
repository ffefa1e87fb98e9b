#include "proto/identity/authority.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/ec.h>

#include <ctime>

#include "proto/identity/openssl_handles.h"

namespace tessera {
namespace {

using std::chrono::seconds;

constexpr std::chrono::hours kAuthorityLifetime{24 * 3650};
constexpr size_t kRequestBytesMax = 4096;  // one with a P-256 key has some 400
constexpr long kX509Version3 = 2;
constexpr size_t kCommonNameMax = 64;  // of X.520; longer names are cut

bool IsIpAddress(const std::string& text) {
  unsigned char bytes[16];
  return ::inet_pton(AF_INET, text.c_str(), bytes) == 1 || ::inet_pton(AF_INET6, text.c_str(), bytes) == 1;
}

void AddExtension(X509* certificate, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const OpensslOwner<X509_EXTENSION, X509_EXTENSION_free> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
  TESSERA_CHECK(extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1);
}

// Adds names as they are: the text form of extensions would give commas a meaning.
void AddNames(X509* certificate, const CertificateTerms& terms) {
  const OpensslOwner<GENERAL_NAMES, GENERAL_NAMES_free> names(sk_GENERAL_NAME_new_null());
  const auto add = [&](int type, const std::string& value) {
    if (GENERAL_NAME* const name = a2i_GENERAL_NAME(nullptr, nullptr, nullptr, type, value.c_str(), 0))
      sk_GENERAL_NAME_push(names.get(), name);
  };
  if (!terms.uri.empty()) add(GEN_URI, terms.uri);
  for (const std::string& each : terms.host_names) add(IsIpAddress(each) ? GEN_IPADD : GEN_DNS, each);
  if (sk_GENERAL_NAME_num(names.get()) == 0) return;
  TESSERA_CHECK(X509_add1_ext_i2d(certificate, NID_subject_alt_name, names.get(), 0, X509V3_ADD_DEFAULT) ==
                1);
}

void SetName(X509_NAME* name, const std::string& common_name) {
  const std::string cut = common_name.substr(0, kCommonNameMax);
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(cut.data()),
                             static_cast<int>(cut.size()), -1, 0);
}

// A certificate of `key`, without a signature.
X509* MakeUnsigned(EVP_PKEY* key, const CertificateTerms& terms, const X509_NAME* issuer, UnixTime now) {
  X509* const made = X509_new();
  TESSERA_CHECK(made != nullptr && X509_set_version(made, kX509Version3) == 1);
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(made), terms.serial);
  ASN1_TIME_set(X509_getm_notBefore(made), static_cast<std::time_t>(now - seconds(kClockTolerance).count()));
  ASN1_TIME_set(X509_getm_notAfter(made), static_cast<std::time_t>(now + terms.lifetime.count()));
  SetName(X509_get_subject_name(made), terms.common_name);
  X509_set_issuer_name(made, issuer != nullptr ? issuer : X509_get_subject_name(made));
  TESSERA_CHECK(X509_set_pubkey(made, key) == 1);
  return made;
}

void AddMemberExtensions(X509* certificate, const CertificateTerms& terms) {
  AddExtension(certificate, NID_basic_constraints, "critical,CA:FALSE");
  AddExtension(certificate, NID_key_usage, "critical,digitalSignature");
  AddExtension(certificate, NID_ext_key_usage,
               terms.purpose == CertificatePurpose::kServer ? "serverAuth" : "clientAuth");
  AddNames(certificate, terms);
}

// Ed25519 signs the message itself, other keys its digest.
void SignWith(X509* certificate, const PrivateKey& key) {
  const EVP_MD* const digest = EVP_PKEY_get_id(key.get()) == EVP_PKEY_ED25519 ? nullptr : EVP_sha256();
  TESSERA_CHECK(X509_sign(certificate, key.get(), digest) > 0);
}

bool IsP256(EVP_PKEY* key) {
  char group[32] = "";
  size_t size = 0;
  return EVP_PKEY_get_base_id(key) == EVP_PKEY_EC &&
         EVP_PKEY_get_group_name(key, group, sizeof group, &size) == 1 &&
         std::string_view(group) == "prime256v1";
}

}  // namespace

std::string MakeSigningRequest(const PrivateKey& key) {
  const OpensslOwner<X509_REQ, X509_REQ_free> request(X509_REQ_new());
  TESSERA_CHECK(request != nullptr && X509_REQ_set_pubkey(request.get(), key.get()) == 1 &&
                X509_REQ_sign(request.get(), key.get(), EVP_sha256()) > 0);
  return BioText([&](BIO* bio) { return PEM_write_bio_X509_REQ(bio, request.get()); });
}

Authority Authority::Make(const std::string& common_name, UnixTime now) {
  PrivateKey key = PrivateKey::Generate();
  CertificateTerms terms;
  terms.common_name = common_name;
  terms.lifetime = kAuthorityLifetime;
  terms.serial = 1;
  X509* const made = MakeUnsigned(key.get(), terms, nullptr, now);
  AddExtension(made, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  AddExtension(made, NID_key_usage, "critical,keyCertSign,cRLSign");
  AddExtension(made, NID_subject_key_identifier, "hash");
  SignWith(made, key);
  return Authority(std::move(key), Certificate(made));
}

Result<Authority> Authority::FromPem(std::string_view pem, const std::string& what) {
  auto key = PrivateKey::FromPem(pem, what);
  if (!key) return key.error();
  auto certificate = Certificate::FromPem(pem, what);
  if (!certificate) return certificate.error();
  if (certificate->KeyDigest() != key->PublicDigest())
    return BadInput(fmt::format("{}: the key does not belong to the certificate", what));
  return Authority(std::move(*key), std::move(*certificate));
}

std::string Authority::Pem() const {
  return key_.Pem() + certificate_.Pem();
}

Result<Certificate> Authority::Sign(std::string_view request_pem, const CertificateTerms& terms,
                                    UnixTime now) const {
  if (request_pem.size() > kRequestBytesMax)
    return BadInput(fmt::format("the signing request is too large (limit {} bytes)", kRequestBytesMax));
  const OpensslOwner<X509_REQ, X509_REQ_free> request(
      PEM_read_bio_X509_REQ(ReadOnlyBio(request_pem).get(), nullptr, nullptr, nullptr));
  if (request == nullptr) return BadInput("the signing request cannot be read");
  EVP_PKEY* const key = X509_REQ_get0_pubkey(request.get());
  if (key == nullptr || !IsP256(key)) return BadInput("the signing request is not for a P-256 key");
  if (X509_REQ_verify(request.get(), key) != 1)
    return BadInput("the signing request is not signed by its own key");
  X509* const made = MakeUnsigned(key, terms, X509_get_subject_name(certificate_.get()), now);
  AddMemberExtensions(made, terms);
  SignWith(made, key_);
  return Certificate(made);
}

Certificate Authority::Issue(const PrivateKey& key, const CertificateTerms& terms, UnixTime now) const {
  X509* const made = MakeUnsigned(key.get(), terms, X509_get_subject_name(certificate_.get()), now);
  AddMemberExtensions(made, terms);
  SignWith(made, key_);
  return Certificate(made);
}

Certificate MakeSelfSigned(const PrivateKey& key, const CertificateTerms& terms, UnixTime now) {
  X509* const made = MakeUnsigned(key.get(), terms, nullptr, now);
  AddMemberExtensions(made, terms);
  SignWith(made, key);
  return Certificate(made);
}

}  // namespace tessera
