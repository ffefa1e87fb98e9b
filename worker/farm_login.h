// How this worker reaches its farm: by a login that it has, by joining with a token, or as a program of the
// coordinator's own user.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "proto/wire/endpoint.h"
#include "worker/options.h"

namespace grpc {
class Channel;
}

namespace tessera {

// Joins the farm if there is a token that was not used here before. An error that says what to do if the
// worker has no way to connect.
Result<Endpoint> ReachFarm(const WorkerOptions& options);

// Renews the certificate of the login whenever that is due, until a stop is requested.
void KeepLoginRenewed(const Login& login, const std::shared_ptr<grpc::Channel>& channel,
                      std::stop_token stop);

}  // namespace tessera
