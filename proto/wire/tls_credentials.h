// Credentials of encrypted connections. Both ends show certificates and speak TLS 1.3, nothing older.
//
// A server lets nobody past the handshake who shows no certificate that `admit` accepts, so a stranger
// reaches no code beyond OpenSSL's. Both ends read their files again when they change: a renewed certificate
// is used for the next connection.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "proto/identity/certificate.h"
#include "proto/identity/tls_files.h"
#include "renderer/util/result.h"

namespace grpc {
class ChannelCredentials;
class ServerCredentials;
}  // namespace grpc

namespace tessera {

// Prepares this process for TLS 1.3, and for no older version. Changes its environment and the order of its
// thread-specific data, so it is called first, before other threads start; later calls do nothing.
void PrepareTls();

// Decides on the certificate of a peer, whose chain begins with its own. The peer has proved that it has the
// key, nothing else. The error is for the log. Called from any thread.
using AdmitPeer = std::function<Result<void>(const std::vector<Certificate>& chain)>;

// `certificate_path` holds the certificate of the server and those that issued it, `key_path` its key; both
// may be one file.
std::shared_ptr<grpc::ServerCredentials> TlsServerCredentials(const std::string& key_path,
                                                              const std::string& certificate_path,
                                                              AdmitPeer admit);

// Of a client that trusts the authorities in `authority_path` alone, which vouch for the key of the
// coordinator whatever its address is (CheckCoordinator). `identity_path` holds its key and certificate.
std::shared_ptr<grpc::ChannelCredentials> TlsClientCredentials(const std::string& authority_path,
                                                               const std::string& identity_path);
// The same with texts in place of files.
std::shared_ptr<grpc::ChannelCredentials> TlsClientCredentials(const std::string& authority_pem,
                                                               const std::string& key_pem,
                                                               const std::string& certificate_pem);
// Of a client with certificates of an organisation. The certificate of the coordinator must be for `host`.
std::shared_ptr<grpc::ChannelCredentials> TlsClientCredentials(const TlsFiles& files,
                                                               const std::string& host);

}  // namespace tessera
