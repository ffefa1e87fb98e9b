#include "coordinator/call_gate.h"

namespace tessera {

Principal CallGate::CallerOf(const grpc::CallbackServerContext& context) {
  Principal caller;
  caller.peer = context.peer();
  return caller;
}

grpc::Status CallGate::Check(const grpc::CallbackServerContext& context, const Principal& caller,
                             const CallRule& rule) const {
  const auto admitted = policy_(caller, rule);
  return admitted ? CheckFarm(context, farm_)
                  : grpc::Status(grpc::StatusCode::PERMISSION_DENIED, admitted.error().message);
}

}  // namespace tessera
