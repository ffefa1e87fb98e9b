#include "proto/identity/tls_files.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "renderer/util/file.h"

namespace tessera {
namespace {

// Group members may read keys: distributions have a group for the programs that use certificates.
constexpr mode_t kTooOpen = 0027;
// Those of all public authorities that a distribution trusts are some 150.
constexpr size_t kAuthoritiesMax = 1000;

Result<PrivateKey> ReadKey(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return SystemError(path, "cannot be examined");
  if (status.st_uid != ::geteuid() && status.st_uid != 0)
    return Failed(
        fmt::format("{}: belongs to another user (uid {}), who could change it", path, status.st_uid));
  if ((status.st_mode & kTooOpen) != 0) {
    return Failed(fmt::format(
        "{}: everybody may read this key, or its group may change it (mode {:o}); run: chmod 640 {}", path,
        status.st_mode & 07777, path));
  }
  const auto pem = ReadFile(path, kPemBytesMax);
  if (!pem) return pem.error();
  return PrivateKey::FromPem(*pem, path);
}

Result<std::vector<Certificate>> ReadCertificates(const std::string& path, size_t count_max) {
  const auto pem = ReadFile(path, count_max * kCertificateBytesMax);
  if (!pem) return pem.error();
  return Certificate::ChainFromPem(*pem, path, count_max);
}

}  // namespace

Result<TlsIdentity> ReadTlsIdentity(const TlsFiles& files, CertificatePurpose purpose, UnixTime now) {
  auto key = ReadKey(files.key);
  if (!key) return key.error();
  auto chain = ReadCertificates(files.certificate, kChainMax);
  if (!chain) return chain.error();
  const Certificate& own = chain->front();
  if (own.KeyDigest() != key->PublicDigest()) {
    return Failed(fmt::format("{}: the first certificate does not belong to the key in {}", files.certificate,
                              files.key));
  }
  if (own.NotAfter() <= now || own.NotBefore() > now) {
    return Failed(fmt::format(
        "{}: the certificate is valid from {} to {}, not now; get a new one, or correct the clock",
        files.certificate, UnixTimeText(own.NotBefore()), UnixTimeText(own.NotAfter())));
  }
  if (!own.IsMeantFor(purpose)) {
    return Failed(fmt::format("{}: the certificate cannot be used by a TLS {} (its extended key usage)",
                              files.certificate,
                              purpose == CertificatePurpose::kServer ? "server" : "client"));
  }
  return TlsIdentity{std::move(*key), std::move(*chain)};
}

Result<std::vector<Certificate>> ReadTlsAuthorities(const TlsFiles& files) {
  return ReadCertificates(files.authority, kAuthoritiesMax);
}

}  // namespace tessera
