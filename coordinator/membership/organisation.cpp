#include "coordinator/membership/organisation.h"

#include "coordinator/membership/farm_identity.h"
#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"
#include "renderer/util/file.h"

namespace tessera {
namespace {

// More than the reader of any of the files accepts.
constexpr uint64_t kFileBytesMax = 8 << 20;

// What tells whether a file has changed.
std::string BytesOf(const std::string& path) {
  const auto bytes = path.empty() ? Result<std::string>(std::string()) : ReadFile(path, kFileBytesMax);
  return bytes ? *bytes : bytes.error().message;
}

}  // namespace

Result<std::shared_ptr<Organisation>> Organisation::Open(TlsFiles files, const Authority& farm,
                                                         std::string served_path, UnixTime now) {
  std::shared_ptr<Organisation> made(new Organisation(std::move(files), farm, std::move(served_path)));
  const auto read = made->Refresh(now);
  if (!read) return read.error();
  return made;
}

Result<bool> Organisation::Refresh(UnixTime now) {
  std::string bytes = BytesOf(files_.key) + BytesOf(files_.certificate) + BytesOf(files_.authority);
  if (bytes == bytes_read_ && now < renewal_due_) return false;
  const auto identity = ReadTlsIdentity(files_, CertificatePurpose::kServer, now);
  if (!identity) return identity.error();
  std::vector<Certificate> authorities;
  if (!files_.authority.empty()) {
    auto read = ReadTlsAuthorities(files_);
    if (!read) return read.error();
    authorities = std::move(*read);
  }
  CertificateTerms terms;
  terms.common_name = "Tessera coordinator";
  terms.host_names = {kCoordinatorName};
  terms.purpose = CertificatePurpose::kServer;
  terms.lifetime = kCoordinatorLifetime;
  terms.serial = static_cast<uint64_t>(now);
  std::string pem = identity->key.Pem();
  for (const Certificate& each : identity->chain) pem += each.Pem();
  pem += farm_.Issue(identity->key, terms, now).Pem() + farm_.certificate().Pem();
  if (auto written = WritePrivateFile(served_path_, pem); !written) return written.error();
  bytes_read_ = std::move(bytes);
  renewal_due_ = now + std::chrono::seconds(kCoordinatorLifetime).count() / 2;
  const std::lock_guard lock(mutex_);
  authorities_ = std::move(authorities);
  return true;
}

std::vector<Certificate> Organisation::authorities() const {
  const std::lock_guard lock(mutex_);
  return authorities_;
}

}  // namespace tessera
