// The web pages over TLS, without a farm.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <mutex>

#include "coordinator/web/web_server.h"
#include "proto/identity/authority.h"
#include "proto/identity/join_token.h"
#include "proto/identity/private_file.h"
#include "proto/identity/subject.h"
#include "tests/coordinator/web/some_content.h"
#include "tests/coordinator/web/tls_client.h"

namespace tessera {

// A web server whose members and tokens are those of the test.
class EncryptedWeb : public testing::Test {
 protected:
  EncryptedWeb() {
    folder_ = testing::TempDir() + "tessera-web-XXXXXX";
    EXPECT_NE(::mkdtemp(folder_.data()), nullptr);
    WriteServerCertificate({"localhost", "*.farm.example", "127.0.0.1", "::1"});
    WebTls tls{path(), path(), {authority_.certificate()}, [this](const auto& chain) -> Result<void> {
                 const auto verdict = CheckCertificate(chain, {authority_.certificate()},
                                                       CertificatePurpose::kClient, UnixNow());
                 if (verdict == CertificateVerdict::kGood) return {};
                 return Failed("the certificate was not issued by this farm");
               }};
    tls.reload_interval = std::chrono::milliseconds(10);
    auto site = std::make_unique<WebSite>(std::vector<std::string>{"named.example"}, content_, Gate());
    web_ =
        std::move(*WebServer::Start(*ParseAddress("127.0.0.1:0", "test"), std::move(tls), std::move(site)));
  }
  ~EncryptedWeb() override { std::filesystem::remove_all(folder_); }

  // Of the certificate that the server shows.
  Digest Fingerprint() const {
    TlsClient client(port());
    EXPECT_TRUE(client.Handshake());
    return client.ServerCertificate().Fingerprint();
  }
  std::string path() const { return folder_ + "/coordinator.pem"; }
  int port() const { return web_->address().port; }

  void WriteServerCertificate(std::vector<std::string> names) {
    CertificateTerms terms;
    terms.common_name = "coordinator";
    terms.host_names = std::move(names);
    terms.purpose = CertificatePurpose::kServer;
    terms.lifetime = std::chrono::hours(1);
    terms.serial = 2;
    const PrivateKey key = PrivateKey::Generate();
    EXPECT_TRUE(WritePrivateFile(
        path(), key.Pem() + authority_.Issue(key, terms, UnixNow()).Pem() + authority_.certificate().Pem()));
  }
  // Key and certificate of a member.
  std::string Identity(const Authority& issuer, const std::string& uri) const {
    CertificateTerms terms;
    terms.common_name = "somebody";
    terms.uri = uri;
    terms.lifetime = std::chrono::hours(1);
    terms.serial = 7;
    const PrivateKey key = PrivateKey::Generate();
    return key.Pem() + issuer.Issue(key, terms, UnixNow()).Pem();
  }
  std::string IdentityOf(Role role) const {
    return Identity(authority_, Subject{role, MemberId{7}, {}}.Uri());
  }
  // A token that counts once.
  std::string MakeToken(const std::string& name = "ada") {
    const JoinToken token = JoinToken::Make("farm:1", {});
    const std::lock_guard lock(mutex_);
    tokens_[token.Key().PublicDigest()] = name;
    return token.Text();
  }
  void Revoke() {
    const std::lock_guard lock(mutex_);
    members_.clear();
  }
  WebClient Browser(const char* source = "127.0.0.1") const { return WebClient(port(), "", source); }

  SomeContent& content() { return *content_; }

  const Authority authority_ = Authority::Make("farm", UnixNow());

 private:
  WebGate Gate() {
    WebGate gate;
    gate.identify = [](const Certificate& certificate) -> Result<Visitor> {
      const auto subject = Subject::Parse(certificate.Uri());
      if (!subject || subject->role == Role::kWorker) return Failed("a worker may not see this");
      return Visitor{subject->id, "somebody", "viewer"};
    };
    gate.recheck = [this](MemberId member) -> Result<Visitor> {
      const std::lock_guard lock(mutex_);
      const auto found = members_.find(member);
      if (found == members_.end()) return Failed("revoked");
      return Visitor{member, found->second, "user"};
    };
    gate.join = [this](const Digest& key, const std::string&) -> Result<Visitor> {
      const std::lock_guard lock(mutex_);
      const auto token = tokens_.extract(key);
      if (token.empty()) return BadInput("this farm does not know the token");
      const MemberId id{++last_member_};
      members_[id] = token.mapped();
      return Visitor{id, token.mapped(), "user"};
    };
    gate.leave = [this](MemberId member, const std::string&) {
      const std::lock_guard lock(mutex_);
      members_.erase(member);
    };
    return gate;
  }

  const std::shared_ptr<SomeContent> content_ = std::make_shared<SomeContent>();
  std::string folder_;
  std::mutex mutex_;
  std::map<Digest, std::string> tokens_;     // guarded by mutex_
  std::map<MemberId, std::string> members_;  // guarded by mutex_
  uint64_t last_member_ = 100;               // guarded by mutex_
  std::unique_ptr<WebServer> web_;
};

}  // namespace tessera
